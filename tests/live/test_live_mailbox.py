"""The crossings between threads lose old values, never order, and never block the writer."""

import pickle
import threading

from studio.live import commands
from studio.live.mailbox import BoundedQueue, Latest


def test_a_slow_reader_sees_only_the_newest_value():
    box: Latest[int] = Latest()
    assert box.get() is None
    for i in range(5):
        box.publish(i)
    assert (box.version, box.get()) == (5, 4)


def test_waiting_returns_at_once_what_was_published_meanwhile():
    box: Latest[int] = Latest()
    box.publish(7)
    assert box.wait(after=0, timeout=0.0) == (1, 7)
    assert box.wait(after=1, timeout=0.01) == (1, 7)


def test_a_waiting_reader_wakes_when_a_value_comes():
    box: Latest[str] = Latest()
    seen = []
    reader = threading.Thread(target=lambda: seen.append(box.wait(0, timeout=5.0)))
    reader.start()
    box.publish("tick")
    reader.join(5.0)
    assert seen == [(1, "tick")]


def test_a_full_queue_refuses_and_keeps_what_it_has_in_order():
    queue: BoundedQueue[int] = BoundedQueue(3)
    assert [queue.put(i) for i in range(5)] == [True, True, True, False, False]
    assert queue.drain() == [0, 1, 2]
    assert queue.drain() == []
    assert queue.put(9)


def test_every_command_and_its_answer_can_be_sent_to_another_process():
    for command in (
        commands.SetMode(mode="live"),
        commands.Stop(),
        commands.StartTake(label="wave"),
        commands.Seek(t=1.0, playing=True, speed=2.0),
        commands.Result(ok=False, why="no", state={"mode": "idle"}),
    ):
        assert pickle.loads(pickle.dumps(command)) == command
