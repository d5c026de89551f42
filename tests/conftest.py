"""Fixtures for every test."""

import os
import shutil
import signal
from pathlib import Path

import pytest

# Families of cases of which `make test` runs one in so many (0: none), and `make thorough`, which CI runs too, the rest:
# each has a sibling that is always run, and costs seconds of processor time. Most are products of lists: a share that
# divides no list's length meets all of its entries.
THINNED = {
    "cli/test_check.py::test_the_commands_of_the_page": 0,
    "cli/test_commands.py::test_new_writes_a_scenario_that_runs": 3,
    "cli/test_extras.py::test_a_missing_package_is_one_line_that_names_its_extra": 2,
    "cli/test_extras.py::test_the_base_installation_does_the_main_things": 2,
    "cli/test_extras.py::test_the_extra_for_pages_is_enough_for_pages": 0,
    "cli/test_fit_motion.py::test_the_parameters_are_found": 2,
    "cli/test_hostile.py::test_names_in_plots": 2,
    "cli/test_hostile.py::test_names_that_are_not_text": 0,
    "cli/test_interrupted.py::test_signals_leave_nothing": 3,
    "cli/test_sweep.py::test_a_part_that_is_damaged_in_its_middle_is_made_again": 3,
    "cli/test_sweep.py::test_killed_at_any_moment_it_ends_with_the_same_bytes": 0,
    "cli/test_terminal.py::test_no_line_folds": 3,
    "codegen/test_equations.py::test_compiled_functions": 10,
    "codegen/test_equations.py::test_graph": 5,
    "codegen/test_source.py::test_compiles_for_lanes_without_a_warning": 5,
    "codegen/test_source.py::test_compiles_without_a_warning": 10,
    "codegen/test_source.py::test_depends_on_the_system_alone": 10,
    "control/test_against_scipy.py::test_a_move_from_point_to_point": 0,
    "control/test_against_scipy.py::test_variants_on_a_sine": 3,
    "explore/test_browser.py::test_legends_keep_their_place_when_light_becomes_dark": 0,
    "explore/test_fitted.py::test_a_fitted_machine_is_shown_in_its_first_recording": 0,
    "explore/test_machine.py::test_the_page_computes_what_run_computes": 2,
    "export/controller/test_controller.py::test_processor_in_the_loop": 3,
    "export/test_c99.py::test_agrees_on_32_bit_arm": 3,
    "export/test_c99.py::test_agrees_with_python": 4,
    "export/test_c99.py::test_check_names_the_bad_constant": 4,
    "export/test_fmu.py::test_valid": 4,
    "export/test_machines.py::test_fmu": 4,
    "export/test_stepping.py::test_the_step_is_that_of_the_exported_c": 4,
    "export/test_tools_document.py::test_python_control": 0,
    "identify/actuator/test_chaos.py::test_a_chaotic_recording_has_intervals_that_hold_the_truth": 0,
    "identify/actuator/test_fit.py::test_a_column_in_degrees_or_of_the_wrong_sign_is_noticed": 0,
    "identify/actuator/test_fit.py::test_intervals_are_those_of_the_noise_that_is_left": 0,
    "identify/actuator/test_laws.py::test_a_law_by_itself_is_searched_again_from_the_static_curve": 0,
    "identify/actuator/test_laws.py::test_laws_left_open_are_searched_again_from_those_that_they_contain": 0,
    "identify/actuator/test_mujoco_joints.py::test_each_joint_s_friction_is_found": 0,
    "identify/actuator/test_told.py::test_noise_of_an_input_is_counted_in_the_intervals": 0,
    "identify/actuator/test_told.py::test_the_sensor_of_one_recording_that_errs_is_named": 2,
    "identify/features/test_filtering.py::test_break_aways_of_a_few_samples_bias_no_interval": 0,
    "identify/methods/test_dynamic.py::test_a_law_constant_is_fitted_when_it_is_freed": 0,
    "identify/methods/test_dynamic.py::test_sigma_0_from_presliding_with_one_percent_noise_is_within_five_percent": 0,
    "identify/methods/test_motion.py::test_the_velocity_for_a_measured_force": 0,
    "identify/methods/test_new_users_log.py::test_more_starts_are_never_worse": 0,
    "identify/methods/test_new_users_log.py::test_progress_rises_to_the_end": 0,
    "identify/methods/test_new_users_log.py::test_the_truth_is_found_from_any_number_of_starts": 2,
    "identify/methods/test_random_records.py::test_a_random_record_is_fitted_or_refused_in_words": 4,
    "identify/statistics/test_uncertainty.py::test_intervals_cover_the_truth_in_twenty_experiments": 0,
    "loops/test_axes.py::test_from_the_log_of_a_stage_to_its_controller": 0,
    "loops/test_design.py::test_an_integral_hunts_against_stiction": 0,
    "loops/test_design.py::test_another_solver_agrees_on_both_sides_of_a_boundary": 0,
    "loops/test_design.py::test_beyond_the_stability_of_the_linear_loop_it_is_unstable": 0,
    "loops/test_design.py::test_compensation_lowers_the_error_after_reversals_by_what_is_said": 0,
    "loops/test_design.py::test_the_commands_of_the_page": 0,
    "machine/test_against_scipy.py::test_columns": 7,
    "machine/test_closed_forms.py::test_the_energy_of_random_machines_balances": 3,
    "machine/test_one_kind.py::test_the_smallest_machine": 2,
    "machine/test_own_elements.py::test_the_machine_of_the_documentation": 0,
    "machine/test_servo.py::test_a_machine_is_the_servo": 2,
    "paper/test_chapters.py::test_the_evidence": 0,
    "paper/test_chapters.py::test_the_matrix": 0,
    "paper/test_page.py::test_numbers": 0,
    "paper/test_page.py::test_the_page_stands_alone": 0,
    "proofs/test_goals.py::test_terms_mean_what_is_evaluated": 0,
    "verify/test_counterexamples.py::test_a_counterexample_is_confirmed_and_a_wrong_one_is_not": 7,
    "verify/test_counterexamples.py::test_powers_rising_exponentials_and_own_constants_are_decided_and_confirmed": 7,
    "properties/test_level.py::test_the_limit_of_v_d_is_that_of_the_lowest_stribeck_curve": 3,
    "properties/test_nasty.py::test_no_verdict_is_wrong": 7,
    "properties/test_properties.py::test_damping_that_falls_with_speed_makes_table_1_passive_up_to_its_threshold": 0,
    "properties/test_properties.py::test_every_majorant_keeps_the_verdicts": 7,
    "properties/test_properties.py::test_laws_that_are_wrong_are_caught": 7,
    "properties/test_properties.py::test_verdicts_with_known_answers": 7,
    "reference/test_machines.py::test_trajectory": 2,
    "reference/test_shared.py::test_trajectory": 3,
    "scenario/test_schema.py::test_mistakes": 7,
    "scenario/test_single_mistakes.py::test_a_wrong_value": 7,
    "scenario/test_single_mistakes.py::test_an_unknown_key": 7,
    "simulation/test_against_scipy.py::test_every_law_under_every_drive": 7,
    "simulation/test_against_scipy.py::test_other_machines": 3,
    "simulation/test_against_scipy.py::test_random_rigs": 7,
    "simulation/test_against_scipy.py::test_signals_that_jump": 3,
    "simulation/test_energy.py::test_balance": 7,
    "simulation/test_ensemble.py::test_every_law": 7,
    "simulation/test_wasm.py::test_every_law_under_every_drive": 7,
    "site/test_site.py::test_a_notebook_runs": 0,
    "site/test_site.py::test_a_script_of_the_gallery": 6,
    "site/test_site.py::test_five_minutes": 2,
    "site/test_site.py::test_the_site_is_built_without_a_warning": 0,
    "properties/steepness/test_steepness.py::test_every_law_and_machine": 5,
    "stories/test_stories.py::test_a_joint_is_fitted_and_put_into_a_simulator": 0,
    "sweeps/test_cluster.py::test_a_law_of_ones_own_goes_along_as_text": 0,
    "sweeps/test_cluster.py::test_a_worker_that_is_stopped_for_ever_is_named_and_its_parts_go_to_others": 0,
    "test_published_records.py::test_a_row_is_what_its_command_prints": 15,
    "test_readme.py::test_commands": 0,
}


def pytest_configure():
    """Let Ctrl-C reach the programs that tests start: a job in a shell's background ignores it, and so do its children."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """Mark what of the families above is left to `make thorough`."""
    seen = {}
    for item in items:
        family = item.nodeid.partition("tests/")[2].partition("[")[0]
        if family in THINNED:
            n = seen[family] = seen.get(family, -1) + 1
            if not THINNED[family] or n % THINNED[family]:
                item.add_marker("thorough")


# The rooms whose subject is what the compiler makes of a system: there it is called as a user's run calls it.
AS_USERS_COMPILE = {"codegen", "control", "machine", "reference", "runtime", "simulation"}
# Elsewhere systems are compiled in a third of the time, and run slower; `make thorough` compiles all as a user's run.
QUICKLY = "-O0"
# Where one system is solved many times: in half the time, and a fifth slower.
SOLVE_MUCH = dict.fromkeys(("identify", "loops"), "-O1 -fexpensive-optimizations -fno-inline-functions-called-once")


@pytest.fixture(scope="session", autouse=True)
def _cache_folder(tmp_path_factory):
    """Compiled systems go into a folder of the test run's own, shared by its workers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STRIBECK_CACHE", str(tmp_path_factory.getbasetemp().parent / "stribeck-cache"))
        yield


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item, nextitem):
    """Choose the compiler before the first fixture of a test compiles."""
    room = Path(item.fspath).relative_to(Path(__file__).parent).parts[0]
    with pytest.MonkeyPatch.context() as patch:
        if room not in AS_USERS_COMPILE and (quick := _quick_compiler(item.config, SOLVE_MUCH.get(room, QUICKLY))):
            patch.setenv("STRIBECK_CC", quick)
        return (yield)


def _quick_compiler(config, options):
    """A script that calls the C compiler with less optimisation; None where there is none, or another was asked for."""
    path = shutil.which("cc") or shutil.which("gcc")
    chosen = os.environ.get("STRIBECK_CC") or os.environ.get("CC")
    if chosen or path is None or os.name != "posix" or config.option.markexpr == "thorough":
        return None
    script = config._tmp_path_factory.getbasetemp().parent / f"stribeck-cc{options.split()[0]}"
    if not script.exists():
        draft = script.with_name(f"{script.name}-{os.getpid()}")
        draft.write_text(f'#!/bin/sh\nexec {path} "$@" {options}\n')
        draft.chmod(0o755)
        os.utime(draft, (0, 0))  # the same file to every worker, and to the cache's key
        draft.replace(script)
    return str(script)


BLANK = (
    '<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" width="9pt" height="9pt" viewBox="0 0 9 9"></svg>\n'
)


@pytest.fixture(autouse=True)
def _blank_pictures(request, monkeypatch):
    """Figures are made but drawn only in tests marked ``pictures``: half of a command's time goes into drawing."""
    if "pictures" not in request.keywords:
        monkeypatch.setattr("stribeck.report.plots.svg", lambda made: BLANK)
        monkeypatch.setattr("stribeck.report.plots.prints", lambda made, pdf: (b"png", b"pdf" if pdf else b""))
