"""Long calls: other threads run meanwhile, signals end them, exceptions of callbacks come out.

No test here depends on speed. A thread can take the interpreter lock from a running thread after
sys.getswitchinterval(); with an interval of minutes, another thread runs only once a call has released
the lock by itself.
"""
import concurrent.futures
import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import vog

LONG_S = 600  # longer than any test


@contextlib.contextmanager
def runs_once_released(action):
    """Runs action() on another thread as soon as the code of the with block releases the interpreter lock.
    Yields an event that is set after it."""
    begin, done = threading.Event(), threading.Event()

    def wait():
        begin.wait()
        action()
        done.set()

    thread = threading.Thread(target=wait)
    thread.start()
    interval = sys.getswitchinterval()
    sys.setswitchinterval(LONG_S)
    begin.set()
    try:
        yield done
    finally:
        sys.setswitchinterval(interval)
        thread.join()


def test_other_threads_run_during_a_call():
    volume = vog.Volume.from_numpy(np.random.default_rng(1).random((96, 96, 96)))
    with runs_once_released(lambda: None) as done:
        vog.convert(volume, budget=2000)
        assert done.is_set()


def test_calls_from_several_threads_agree(cloud):
    expected = vog.convert(cloud, block=4)
    scene = vog.Scene(expected)
    cameras = [vog.Camera.orbit(expected, azimuth) for azimuth in np.linspace(0, 345, 12)]
    pictures = [scene.render(camera, 64).values for camera in cameras]
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        models = list(pool.map(lambda _: vog.convert(cloud, block=4), range(6)))
        drawn = list(pool.map(lambda camera: scene.render(camera, 64), cameras))
    assert all(np.array_equal(model.mean, expected.mean) for model in models)
    assert all(np.array_equal(one.values, picture) for one, picture in zip(drawn, pictures))


# Each takes minutes unless it is interrupted.
@pytest.mark.parametrize(
    "call",
    [
        "vog.convert(volume, error=1e-6)",
        "vog.convert(volume, budget=10**6, refine_seconds=1000)",
        "vog.render(volume, size=6000, interpolation='linear', step=0.01)",
        "vog.render(model, size=16000, renderer='trace')",
        "vog.sample_cloud(1024)",
        "vog.sample_particles(256)",
        "vog.evaluate(volume, sys.argv[1] + '/out')",
    ],
)
def test_ctrl_c_ends_the_call(call, tmp_path):
    # In a process of its own: there the handler is Python's own, and the call is on the main thread. Another
    # thread sends the signal once the call has released the interpreter lock.
    script = f"""
import numpy as np, os, signal, sys, threading, vog
volume = vog.Volume.from_numpy(np.random.default_rng(1).random((128, 128, 128)))
model = vog.convert(volume, block=2)
begin = threading.Event()
def interrupt():
    begin.wait()
    os.kill(os.getpid(), signal.SIGINT)
thread = threading.Thread(target=interrupt)
thread.start()
sys.setswitchinterval({LONG_S})
try:
    begin.set()
    {call}
    print("not interrupted")
except KeyboardInterrupt:
    print("interrupted", len(vog.convert(vog.sample_cloud(64), block=8)) > 0)
"""
    done = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, timeout=LONG_S
    )
    assert done.stdout == "interrupted True\n", done.stderr


def alarm():
    """Sends this process the signal of the tests below."""
    os.kill(os.getpid(), signal.SIGUSR1)


@contextlib.contextmanager
def handler(function):
    old = signal.signal(signal.SIGUSR1, function)
    try:
        yield
    finally:
        signal.signal(signal.SIGUSR1, old)


def test_a_handler_that_returns_does_not_end_the_call():
    calls = []
    volume = vog.Volume.from_numpy(np.random.default_rng(1).random((96, 96, 96)))
    with handler(lambda *_: calls.append(1)), runs_once_released(alarm) as done:
        model = vog.convert(volume, budget=3000)
        assert done.is_set()
    assert len(model) > 0 and len(calls) == 1


def test_a_handlers_own_exception_comes_out():
    class Alarm(Exception):
        pass

    def throw(*_):
        raise Alarm

    volume = vog.Volume.from_numpy(np.random.default_rng(1).random((128, 128, 128)))
    with handler(throw), runs_once_released(alarm), pytest.raises(Alarm):
        vog.convert(volume, error=1e-6)


def test_exceptions_of_a_progress_callback_come_out(cloud, model):
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
