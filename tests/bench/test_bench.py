"""The bench measures real runs, and compares figures by where they stand."""

import json

import numpy as np
import pytest
from fake_clock import FakeClock

from studio.bench import journeys as bench_journeys
from studio.bench import live as bench_live
from studio.bench import page as bench_page
from studio.bench import training
from studio.bench.frames import frame_latency
from studio.bench.run import compare, percentiles, run_bench
from studio.bench.stop import MORE, stop_latency
from studio.bench.takes import long_take, performed, takes_cost
from studio.bench.training import (
    environment_step,
    in_turns,
    mapper_growth,
    physics_step,
    training_rates,
)
from studio.errors import StudioError
from studio.evaluation import browser as bench_browser
from studio.options import BenchConfig
from studio.rl.bank import build_bank


def test_percentiles_of_a_known_row():
    figures = percentiles(np.arange(101, dtype=float))
    assert figures == {"p50": 50.0, "p95": 95.0, "p99": 99.0, "max": 100.0}


def test_comparing_gives_the_ratio_of_every_figure_that_both_have():
    now = {"machine": {"cores": 2}, "a": {"b": 3.0, "new": 1.0}, "rows": [{"x": 4}], "name": "n"}
    earlier = {"machine": {"cores": 8}, "a": {"b": 2.0}, "rows": [{"x": 1}, {"x": 2}]}
    assert compare(now, earlier) == {
        "a.b": {"now": 3.0, "earlier": 2.0, "ratio": 1.5},
        "rows.0.x": {"now": 4.0, "earlier": 1.0, "ratio": 4.0},
    }


def test_a_short_bench_names_the_machine_and_every_section_and_compares(tmp_path):
    first = run_bench(BenchConfig(seconds=1.0, page=False, training=False, takes=False))
    assert first["machine"]["cores"] >= 1
    assert {"features", "selector", "mapper", "consistency", "controller", "inference"} <= set(
        first["sections_ms"]
    )
    assert first["drive"]["times_real_time_cpu"] > 0.0
    path = tmp_path / "before.json"
    path.write_text(json.dumps(first))
    second = run_bench(
        BenchConfig(seconds=1.0, page=False, training=False, takes=False, compare=path)
    )
    assert second["compared"]["drive.seconds"]["ratio"] == pytest.approx(1.0)


def test_an_unreadable_comparison_is_said_before_anything_is_measured(tmp_path):
    with pytest.raises(StudioError, match="compare"):
        run_bench(BenchConfig(compare=tmp_path / "nothing.json"))


def test_what_is_compared_takes_turns_and_every_environment_counts(monkeypatch):
    """By a clock that only the work turns: a step of 1/64 s, and one of 1/128 s."""
    order: list[str] = []
    clock = FakeClock()
    monkeypatch.setattr(training.time, "perf_counter", clock.now)

    def takes(name: str, seconds: float):
        return lambda: (order.append(name), clock.advance(seconds))

    slow, quick = in_turns((takes("slow", 1 / 64), takes("quick", 1 / 128)), 16, 0.75, rounds=3)
    assert (slow, quick) == (16 * 64, 16 * 128)
    changes = [name for k, name in enumerate(order[2:]) if order[k + 1] != name]
    assert changes == ["slow", "quick"] * 3


def test_physics_is_timed_of_robots_that_stand():
    (rate,) = in_turns((physics_step(16),), 16, 0.2)
    assert 0.0 < rate < np.inf


@pytest.mark.slow
@pytest.mark.long
def test_training_is_rated_by_environments_and_as_a_share_of_bare_physics(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # training keeps its banks under runs/
    *rows, ppo = training_rates(
        0.1, sizes=(2, 16), ppo_envs=8, ppo_samples=400, motions=1, rounds=2
    )
    assert [row["num_envs"] for row in rows] == [2, 16]
    for row in rows:
        assert row["environment_per_s"] > 0.0
        assert row["environment_share"] == pytest.approx(
            row["environment_per_s"] / row["physics_per_s"]
        )
    assert ppo["num_envs"] == 8
    for name in ("ppo", "ppo_mirrored"):
        assert ppo[f"{name}_per_s"] > 0.0
        assert ppo[f"{name}_share"] == pytest.approx(ppo[f"{name}_per_s"] / ppo["physics_per_s"])


def test_a_rate_counts_every_robot_of_every_step(monkeypatch):
    """By a clock that a step turns by 1/64 s."""
    bank, clock = build_bank("sit", per_task=1, seconds=2.0, difficulties=(0.4, 1.0)), FakeClock()
    monkeypatch.setattr(training.time, "perf_counter", clock.now)
    for n in (2, 8):
        step = environment_step(n, bank)
        (rate,) = in_turns((lambda step=step: (step(), clock.advance(1 / 64)),), n, 0.25, rounds=1)
        assert rate == n * 64


@pytest.mark.slow
def test_four_pages_get_thirty_updates_a_second_on_both_sockets():
    done = bench_live.live(3.0)
    for rate in (*done["updates_per_second"], *done["view_updates_per_second"]):
        assert rate > 0.0
    assert 0.0 < done["cpu_share_alone"] < done["cpu_share"] + 0.1


@pytest.mark.slow
def test_frames_come_back_in_ticks_and_their_way_is_measured():
    done = frame_latency(3.0)
    took = done["sent_to_tick_ms"]
    assert 0.0 < took["p50"] <= took["p95"] <= took["p99"]
    assert 0.5 < done["seen_share"] <= 1.0
    assert done["arrivals"]["rate_hz"] > 0.0


@pytest.mark.slow
def test_stops_are_answered_by_both_ways_beside_pages_a_training_imports_and_a_flood():
    figures = stop_latency(stops=3, floods=("cameras",))
    assert list(figures) == [*MORE, "cameras"]
    for case in figures.values():
        for way in ("socket_ms", "post_ms"):
            assert 0.0 < case[way]["p50"] <= case[way]["p95"] <= case[way]["p99"]


def test_without_a_browser_what_needs_one_is_skipped_and_says_so(monkeypatch):
    monkeypatch.setattr(bench_browser.shutil, "which", lambda _: None)
    for measure in (bench_live.loop_beside_browser, bench_page.page):
        assert "install chromium" in measure(1.0)["skipped"]
    assert "install chromium" in bench_journeys.journeys()["skipped"]


def test_of_a_trace_the_tasks_of_a_page_s_main_thread_count_and_no_others():
    name = {"name": "thread_name", "pid": 7}
    task = {"name": "ThreadControllerImpl::RunTask", "pid": 7}
    events = [
        {**name, "tid": 1, "args": {"name": "CrRendererMain"}},
        {**name, "tid": 2, "args": {"name": "Compositor"}},
        {**task, "tid": 1, "dur": 1500},
        {**task, "tid": 2, "dur": 90_000},
        {**task, "tid": 1, "pid": 8, "dur": 80_000},
        {"name": "V8.GC", "pid": 7, "tid": 1, "dur": 70_000},
    ]
    assert bench_browser.main_thread_ms(events) == [1.5]


@pytest.mark.long
@pytest.mark.browser
def test_the_page_is_measured_as_it_starts_and_draws(monkeypatch):
    monkeypatch.setattr(bench_page, "WARM_UP", 1.0)
    figures = bench_page.page(4.0)
    if "skipped" in figures:
        pytest.skip(figures["skipped"])
    assert figures["ready_s"] > 0.0
    assert 50_000 < figures["own_js_bytes"] < 150_000
    assert 0.0 < figures["updates_per_second"] <= figures["frames_per_second"]
    assert figures["longest_block_ms"] > 0.0
    assert 0.0 <= figures["blocked_share"] <= 1.0


@pytest.mark.browser
def test_the_loop_keeps_ticking_beside_a_browser_that_draws_the_page(monkeypatch):
    monkeypatch.setattr(bench_live, "WARM_UP", 1.0)
    figures = bench_live.loop_beside_browser(8.0)
    if "skipped" in figures:
        pytest.skip(figures["skipped"])
    assert figures["frames_drawn_per_second"] > 0.0
    assert figures["frames"] > 30
    assert 0.0 <= figures["period_error_ms"]["p50"] <= figures["period_error_ms"]["p95"]
    assert figures["period_error_ms"]["p95"] <= figures["period_error_ms"]["p99"]


@pytest.mark.slow
def test_takes_are_listed_and_looked_at():
    cost = takes_cost(takes=20, minutes=(0.1,))
    assert cost["list"]["takes"] == 20
    assert cost["list"]["p50_s"] > 0.0
    (look,) = cost["long"]
    assert look["minutes"] == 0.1
    assert {"append_us", "review_s", "review_own_mb", "seek_ms_p95", "window_ms_p95"} <= set(look)


@pytest.mark.slow
@pytest.mark.long
def test_ten_times_as_long_a_take_is_reviewed_in_the_same_memory(tmp_path):
    pattern = performed(10.0)
    short, long = (long_take(tmp_path, pattern, minutes) for minutes in (1.5, 15.0))
    assert long["review_own_mb"] < short["review_own_mb"] + 15.0
    assert long["review_own_mb"] < 60.0
    assert long["seek_ms_p95"] > 0.0
    assert long["window_ms_p95"] > 0.0


@pytest.mark.slow
def test_training_s_growth_is_measured_by_the_same_number_of_looks_at_each_pair():
    growth = mapper_growth(sizes=(500, 2_000, 8_000), epochs=5)
    assert [row["pairs"] for row in growth["rows"]] == [500, 2_000, 8_000]
    few, _, many = (row["steps"] for row in growth["rows"])
    assert many == pytest.approx(16 * few, rel=0.2)  # of those not held out
    assert np.isfinite(growth["exponent"])


@pytest.mark.long
@pytest.mark.browser
def test_who_sees_only_the_screen_drives_with_one_click_and_trains_with_two():
    figures = bench_journeys.journeys(("keyboard", "clip", "mapper"))
    if "skipped" in figures:
        pytest.skip(figures["skipped"])
    assert {name: one["clicks"] for name, one in figures.items()} == {
        "keyboard": 1, "clip": 0, "mapper": 2,
    }, figures  # fmt: skip
    assert all(one.get("seconds", 0.0) > 0.0 for one in figures.values()), figures
