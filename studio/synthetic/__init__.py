"""The synthetic person: a body, habits and a sensor that turn intents into human motion."""

from studio.synthetic.body import Body
from studio.synthetic.exercises import exercise, squats
from studio.synthetic.habits import Habits
from studio.synthetic.perform import Performance, Performer, perform, play
from studio.synthetic.person import FAMILIES, Person
from studio.synthetic.sensor import SENSORS, Sensor

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
    "perform",
    "play",
    "squats",
]
