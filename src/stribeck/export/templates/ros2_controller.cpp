// {{ about[0] }} As a controller plugin of ros2_control.
// {{ about[-1] }}
// It claims JOINT/effort, reads JOINT/position, and takes its reference from the topic ~/reference: value{% if rate %}, rate{% endif %}{% if second %}, second{% endif %}
// derivative as std_msgs/Float64MultiArray; until one came the joint is held where it was. A sample is taken every
// {{ repr(b.step) }} s, whatever the manager's rate, and its output is held.
#include <array>
#include <memory>
#include <string>

#include <controller_interface/controller_interface.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>
#include <realtime_tools/realtime_buffer.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>

#include "{{ P }}.h"

namespace stribeck
{
class {{ cls }} : public controller_interface::ControllerInterface
{
  using Return = controller_interface::CallbackReturn;
  using Message = std_msgs::msg::Float64MultiArray;
  using Reference = std::array<double, 3>;

public:
  Return on_init() override
  {
    {{ P }}_defaults(&p_);
    auto_declare<std::string>("joint", "joint");
{% for name, (c, value, path) in b.constants.items() if name != "period" and not name.startswith("signal_") %}
    auto_declare<double>("{{ name }}", p_.{{ name }});
{% endfor %}
    return Return::SUCCESS;
  }

  controller_interface::InterfaceConfiguration command_interface_configuration() const override
  {
    return {controller_interface::interface_configuration_type::INDIVIDUAL, {joint_ + "/effort"}};
  }

  controller_interface::InterfaceConfiguration state_interface_configuration() const override
  {
    return {controller_interface::interface_configuration_type::INDIVIDUAL, {joint_ + "/position"}};
  }

  Return on_configure(const rclcpp_lifecycle::State &) override
  {
    joint_ = get_node()->get_parameter("joint").as_string();
{% for name, (c, value, path) in b.constants.items() if name != "period" and not name.startswith("signal_") %}
    p_.{{ name }} = get_node()->get_parameter("{{ name }}").as_double();
{% endfor %}
    if (const int status = {{ P }}_check(&p_); status != {{ P }}_OK) {
      RCLCPP_ERROR(get_node()->get_logger(), "a constant is not allowed: see error %d of {{ P }}.h", status);
      return Return::ERROR;
    }
    subscription_ = get_node()->create_subscription<Message>(
      "~/reference", rclcpp::SystemDefaultsQoS(), [this](const std::shared_ptr<Message> message) {
        Reference found{};
        for (std::size_t i = 0; i < found.size() && i < message->data.size(); ++i) found[i] = message->data[i];
        if (!message->data.empty()) reference_.writeFromNonRT(found);
      });
    return Return::SUCCESS;
  }

  Return on_activate(const rclcpp_lifecycle::State &) override
  {
    {{ P }}_reset(&state_);
    waited_ = p_.period;
    output_ = 0.0;
    reference_.writeFromNonRT(Reference{state_interfaces_[0].get_value(), 0.0, 0.0});
    return Return::SUCCESS;
  }

  Return on_deactivate(const rclcpp_lifecycle::State &) override
  {
    command_interfaces_[0].set_value(0.0);
    return Return::SUCCESS;
  }

  controller_interface::return_type update(const rclcpp::Time &, const rclcpp::Duration & passed) override
  {
    waited_ += passed.seconds();
    if (waited_ >= p_.period * (1.0 - 1e-6)) {
      waited_ = waited_ < 2.0 * p_.period ? waited_ - p_.period : 0.0;
      const Reference & asked = *reference_.readFromRT();
      {{ P }}_input in{};
      {{ P }}_output out{};
      in.r = asked[0];
{% if rate %}
      in.r_rate = asked[1];
{% endif %}
{% if second %}
      in.r_second = asked[2];
{% endif %}
      in.y = state_interfaces_[0].get_value();
      if ({{ P }}_step(&p_, &state_, &in, &out) != {{ P }}_OK) {
        command_interfaces_[0].set_value(0.0);
        return controller_interface::return_type::ERROR;
      }
      output_ = out.u;
    }
    command_interfaces_[0].set_value(output_);
    return controller_interface::return_type::OK;
  }

private:
  {{ P }}_parameters p_{};
  {{ P }}_state state_{};
  double waited_ = 0.0, output_ = 0.0;
  std::string joint_ = "joint";
  realtime_tools::RealtimeBuffer<Reference> reference_;
  rclcpp::Subscription<Message>::SharedPtr subscription_;
};
}  // namespace stribeck

PLUGINLIB_EXPORT_CLASS(stribeck::{{ cls }}, controller_interface::ControllerInterface)
