"""What hosts an exported controller: MuJoCo (loaded and run), ros2_control (syntax alone), MIT gains, cogging."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck import Scenario
from tests.export.controller.stages import RUB, stage
from tests.export.harness import need
from tests.machine.machines import machine

# What the plugin uses of ROS, declared and nothing more: this checks that it is C++ and calls what it means to, not that
# it builds in a distribution of ROS.
ROS = {
    "controller_interface/controller_interface.hpp": """
#pragma once
#include <memory>
#include <string>
#include <vector>
#include <functional>
#include <rclcpp/rclcpp.hpp>
struct Slot { double get_value() const; void set_value(double); };
namespace controller_interface {
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };
struct InterfaceConfiguration { interface_configuration_type type; std::vector<std::string> names; };
struct ControllerInterface {
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) = 0;
  virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;
  template <class T> void auto_declare(const std::string &, const T &) {}
  std::shared_ptr<rclcpp::Node> get_node() const;
  std::vector<Slot> command_interfaces_, state_interfaces_;
};
}
""",
    "rclcpp/rclcpp.hpp": """
#pragma once
#include <functional>
#include <memory>
#include <string>
namespace rclcpp_lifecycle { struct State {}; }
namespace rclcpp {
struct Time {}; struct Logger {}; struct SystemDefaultsQoS {};
struct Duration { double seconds() const; };
struct Parameter { double as_double() const; std::string as_string() const; };
template <class M> struct Subscription { using SharedPtr = std::shared_ptr<Subscription>; };
struct Node {
  Parameter get_parameter(const std::string &) const;
  Logger get_logger() const;
  template <class M, class Q, class F> typename Subscription<M>::SharedPtr create_subscription(const std::string &, Q, F f)
  { std::function<void(std::shared_ptr<M>)> call = f; return {}; }
};
}
#define RCLCPP_ERROR(logger, ...) ((void)(logger))
""",
    "realtime_tools/realtime_buffer.hpp": """
#pragma once
namespace realtime_tools {
template <class T> struct RealtimeBuffer { void writeFromNonRT(const T &) {} T * readFromRT() { return &x; } T x{}; };
}
""",
    "std_msgs/msg/float64_multi_array.hpp": """
#pragma once
#include <vector>
namespace std_msgs { namespace msg { struct Float64MultiArray { std::vector<double> data; }; } }
""",
    "pluginlib/class_list_macros.hpp": """
#pragma once
#define PLUGINLIB_EXPORT_CLASS(a, b) static_assert(std::is_base_of<b, a>::value && !std::is_abstract<a>::value, "");
#include <type_traits>
""",
}


@pytest.mark.parametrize("case", ["measured", "filtered"])
def test_the_ros2_control_plugin_is_cpp(case, tmp_path):
    need("g++")
    files = stribeck.export(stage(case), "ros2_control", tmp_path / "package", part="controller")
    names = {file.name for file in files}
    assert {"package.xml", "CMakeLists.txt", "plugin.xml", "controllers.yaml", "stage_axis_controller.cpp"} <= names
    for name, text in ROS.items():
        (tmp_path / "ros" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "ros" / name).write_text(text)
    words = ["g++", "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", f"-I{tmp_path / 'ros'}"]
    subprocess.run([*words, str(tmp_path / "package" / "stage_axis_controller.cpp")], check=True)


def test_the_mujoco_plugin_moves_as_the_simulation(tmp_path):
    """Built against MuJoCo's own headers, loaded, run: the body goes where the simulated one does, the nearer the smaller
    MuJoCo's steps are. In a process of its own, since a plugin stays loaded."""
    need("gcc")
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    place = Path(mujoco.__file__).parent
    library = next(iter(place.glob("libmujoco.so.*")), None)
    if library is None or not (place / "include" / "mujoco" / "mjplugin.h").exists():
        pytest.skip("this package of MuJoCo has no headers or library")
    data = stage().data  # without its contact: friction is not in MuJoCo's model
    data = {**data, "contacts": {}, "controllers": {"axis": {**data["controllers"]["axis"]}}}
    data["controllers"]["axis"]["compensation"] = {"law": RUB, "speed": "measured", "share": 0.3}
    free = Scenario(data)
    stribeck.export(free, "mujoco_plugin", tmp_path, part="controller")
    sources = [str(tmp_path / name) for name in ("stage_axis.c", "stage_axis_mujoco.c")]
    words = ["gcc", "-std=c99", "-O2", "-shared", "-fPIC", f"-I{place / 'include'}", *sources, str(library), "-lm"]
    subprocess.run([*words, "-o", str(tmp_path / "plugin.so")], check=True)
    script = f"""
import mujoco
mujoco.mj_loadPluginLibrary({str(tmp_path / "plugin.so")!r})
model = mujoco.MjModel.from_xml_path({str(tmp_path / "stage_axis.xml")!r})
for parts in (10, 40):
    model.opt.timestep = 1e-3 / parts
    data = mujoco.MjData(model)
    for k in range(400 * parts):
        if k % parts == 0:
            print(data.qpos[0])
        mujoco.mj_step(model, data)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    coarse, fine = np.array([float(x) for x in done.stdout.split()]).reshape(2, -1)
    exact = np.asarray(stribeck.simulate(free)["a.y"])[:-1]
    size = np.abs(exact).max()
    assert size > 0.01
    assert np.abs(coarse - exact).max() < 6e-3 * size
    assert np.abs(fine - exact).max() < 2e-3 * size


def joint(**controller):
    own = {
        "kind": "cascade",
        "on": "m",
        "measures": "a",
        "K_p": 20.0,
        "K_v": 0.5,
        "signal": {"kind": "step", "value": 0.1, "time": 0.0},
    }
    ripple = {"on": "a", "kind": "ripple", "amplitude": [0.02, 0.005], "waves": [12, 84], "phase": [0.3, 0.0]}
    return machine(
        {"a": {"inertia": 0.01}},
        0.1,
        energy=False,
        loads={"cogging": ripple},
        motors={"m": {"on": "a", "K": 0.1, "R": 1.0}},
        controllers={"axis": {**own, **controller}},
    )


def test_gains_of_a_drive_in_mit_mode(tmp_path):
    (file,) = stribeck.export(Scenario(joint()), "mit", tmp_path / "g.yaml", part="controller", step=1e-3)
    text = file.read_text()
    assert "  kp: 10.0  #" in text
    assert "  kd: 0.5  #" in text
    assert "dither" not in text
    shaken = Scenario(joint(dither={"amplitude": 0.02, "frequency": 60.0}))
    (file,) = stribeck.export(shaken, "mit", tmp_path / "d.yaml", part="controller", step=1e-3)
    assert "    amplitude: 0.02  #" in file.read_text()
    with pytest.raises(stribeck.InputError, match="MIT mode has kp and kd alone"):
        stribeck.export(Scenario(joint(T_i=0.1)), "mit", tmp_path / "h.yaml", part="controller", step=1e-3)


def test_cogging_tables_cancel_the_ripple(tmp_path):
    """Compiled and asked at angles of its own, each table gives the torque that the machine's ripple takes away."""
    need("gcc")
    scenario = Scenario(joint())
    (simplefoc,) = stribeck.export(scenario, "simplefoc", tmp_path / "s.h", part="cogging")
    (odrive,) = stribeck.export(scenario, "odrive", tmp_path / "o.h", part="cogging")
    name = scenario.name
    (tmp_path / "main.c").write_text(
        f'#include <stdio.h>\n#include "s.h"\n#include "o.h"\nint main(void) {{ float a; while (scanf("%f", &a) == 1) '
        f'printf("%g %g\\n", {name}_cogging(a), {name}_cogging_map[(int)((a * 0.159154943F + 4) * 3600) % 3600]); return 0; }}\n'
    )
    subprocess.run(["gcc", "-std=c99", str(tmp_path / "main.c"), "-o", str(tmp_path / "main"), "-lm"], check=True)
    angle = np.random.default_rng(1).uniform(-6, 6, 200).astype(np.float32)
    done = subprocess.run(
        [tmp_path / "main"], input=" ".join(map(str, angle)), capture_output=True, text=True, check=True
    )
    found = np.array([float(x) for x in done.stdout.split()]).reshape(-1, 2).T
    cogging = 0.02 * np.sin(12 * angle + 0.3) + 0.005 * np.sin(84 * angle)
    start = stribeck.simulate(Scenario(joint(K_p=0.0, K_v=0.0)))
    assert float(start["cogging.f"][0]) == pytest.approx(0.02 * np.sin(0.3))  # positive: pushes forward
    assert np.abs(0.1 * found[0] + cogging).max() < 1e-3
    assert np.abs(found[1] + cogging).max() < 2e-3
    assert odrive.read_text().count("F,") >= 3599
    assert "feed_forward_current.q" in simplefoc.read_text()
    with pytest.raises(stribeck.InputError, match="must be one"):
        stribeck.export(stage(), "odrive", tmp_path / "n.h", part="cogging")
