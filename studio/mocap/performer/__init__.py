"""The synthetic person: a body, habits and a sensor that turn intents into human motion."""

from studio.mocap.performer.body import Body
from studio.mocap.performer.exercises import exercise, labels, squats
from studio.mocap.performer.perform import Performance, Performer, perform, play
from studio.mocap.performer.person import FAMILIES, Habits, Person
from studio.mocap.performer.sensor import SENSORS, Sensor

__all__ = [
    "FAMILIES",
    "SENSORS",
    "Body",
    "Habits",
    "Performance",
    "Performer",
    "Person",
    "Sensor",
    "exercise",
    "labels",
    "perform",
    "play",
    "squats",
]
