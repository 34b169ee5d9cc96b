"""Long calls: other threads run meanwhile, signals end them, callbacks may throw."""
import concurrent.futures
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import vog

# A conversion of seconds: an error that the finest cut just reaches, of much noise.
LONG = """
import numpy as np, vog, signal, sys, time
volume = vog.Volume.from_numpy(np.random.default_rng(1).random((128, 128, 128)))
"""


def long_volume():
    return vog.Volume.from_numpy(np.random.default_rng(1).random((96, 96, 96)))


def test_other_threads_run_during_a_call():
    volume = long_volume()
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.002)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    vog.convert(volume, budget=2000)
    end = time.monotonic()
    done.set()
    thread.join()
    during = [t for t in ticks if begin < t < end]
    # With the lock held there would be none but at the edges.
    assert end - begin > 0.1 and len(during) > 10, (end - begin, len(during))


def test_calls_from_several_threads_agree(cloud):
    expected = vog.convert(cloud, block=4)
    scene = vog.Scene(expected)
    cameras = [vog.Camera.orbit(expected, azimuth) for azimuth in np.linspace(0, 6, 12)]
    pictures = [scene.render(camera, 64).depth.copy() for camera in cameras]
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        models = list(pool.map(lambda _: vog.convert(cloud, block=4), range(6)))
        drawn = list(pool.map(lambda camera: scene.render(camera, 64), cameras))
    assert all(np.array_equal(model.mean, expected.mean) for model in models)
    assert all(np.array_equal(depth.depth, picture) for depth, picture in zip(drawn, pictures))


@pytest.mark.parametrize(
    "call",
    [
        "vog.convert(volume, error=1e-6)",
        "vog.convert(volume, budget=10**6, refine_seconds=1000)",
        "vog.render(volume, size=6000, interpolation='linear', step=0.01)",
        "vog.render(vog.convert(volume, block=1), size=4000, renderer='trace')",
        "vog.sample_cloud(1024)",
        "vog.sample_particles(256)",
        "vog.evaluate(volume, sys.argv[1] + '/out')",
    ],
)
def test_ctrl_c_ends_the_call(call, tmp_path):
    # In a process of its own: there the handler is Python's own, and the call is on the main thread.
    script = f"""{LONG}
print("go", flush=True)
begin = time.monotonic()
try:
    {call}
    print("not interrupted")
except KeyboardInterrupt:
    print("interrupted", len(vog.convert(vog.sample_cloud(64), block=8)) > 0)
"""
    process = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "go\n", process.stderr.read()
    time.sleep(0.7)
    process.send_signal(signal.SIGINT)
    sent = time.monotonic()
    out, error = process.communicate(timeout=60)
    assert out == "interrupted True\n", error
    # Some tens of milliseconds on an idle machine; another conversion is part of it.
    assert time.monotonic() - sent < 10


def test_a_handler_that_returns_does_not_end_the_call(cloud):
    seen = []
    old = signal.signal(signal.SIGALRM, lambda *_: seen.append(time.monotonic()))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        model = vog.convert(long_volume(), budget=3000)
        end = time.monotonic()
    finally:
        signal.signal(signal.SIGALRM, old)
    assert len(model) > 0 and len(seen) == 1 and seen[0] < end


def test_a_handlers_own_exception_comes_out(cloud):
    class Timeout(Exception):
        pass

    def handler(*_):
        raise Timeout

    old = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with pytest.raises(Timeout):
            vog.convert(long_volume(), error=1e-6)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)


def test_what_a_progress_callback_throws_comes_out(cloud, model):
    def throw(fraction):
        raise KeyError(fraction)

    for call in (
        lambda: vog.convert(cloud, budget=100, progress=throw),
        lambda: vog.convert(cloud, method="paper", progress=throw),
        lambda: vog.render(model, size=100, progress=throw),
        lambda: vog.render(cloud, size=100, progress=throw),
        lambda: vog.render(model, size=100, renderer="trace", progress=throw),
    ):
        with pytest.raises(KeyError):
            call()


def test_progress_is_called_from_any_thread_without_a_deadlock(cloud):
    for _ in range(20):
        fractions = []
        vog.render(cloud, size=128, progress=fractions.append)
        assert fractions[-1] == 1 and len(fractions) == 64


def _count(model):
    return len(model)


def test_models_go_to_other_processes(model):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(_count, [model, model[:3]]) == [len(model), 3]
