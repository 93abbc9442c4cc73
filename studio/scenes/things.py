"""Props that scenes share: marks, targets on strings, poles, balls."""

from studio.sim.props import PropShape

ORANGE, BONE, WOOD, BLUE, LIME = (
    (0.95, 0.45, 0.1), (0.93, 0.9, 0.8), (0.72, 0.53, 0.34), (0.16, 0.44, 0.6), (0.75, 0.85, 0.2),
)  # fmt: skip


def mark(name: str, x: float, y: float, radius: float) -> PropShape:
    """A disc on the floor, which nothing touches."""
    return PropShape(
        name=name,
        kind="cylinder",
        size=(radius, 0.001),
        pos=(x, y, 0.001),
        held="drawn",
        color=BLUE,
    )


def hung_ball(name: str, x: float, y: float, z: float, radius: float) -> PropShape:
    """A ball on a string."""
    return PropShape(
        name=name,
        kind="ball",
        size=(radius,),
        pos=(x, y, z),
        held="hung",
        mass=0.1,
        color=LIME,
    )


def thrown_ball(name: str = "ball") -> PropShape:
    """A soft ball of 10 cm that waits aside until it is thrown."""
    return PropShape(
        name=name, kind="ball", size=(0.05,), pos=(-2.0, 2.0, 0.05), held="free", mass=0.06,
        color=ORANGE,
    )  # fmt: skip


def pole(name: str, x: float, y: float, height: float = 0.6) -> PropShape:
    """A pole of 6 cm that stands fast."""
    return PropShape(
        name=name, kind="cylinder", size=(0.03, 0.5 * height), pos=(x, y, 0.5 * height),
    )  # fmt: skip
