"""The code under test: a base that drives along a corridor and gives way to people."""


class Base:
    """The base. Each state is a method of its name, which returns the wanted speed in m/s."""

    stop_m = 1.5
    slow_m = 3.0
    braking = 2.0  # m/s²

    def __init__(self, goal_m: float) -> None:
        self.goal_m = goal_m
        self.x_m = self.speed = 0.0
        self.state = "drive"

    def step(self, person_m: float, seconds: float) -> None:
        """Choose a state by the distance of the nearest person, and move."""
        self.state = self.next_state(person_m)
        wanted: float = getattr(self, self.state)()
        change = self.braking * seconds
        self.speed = max(self.speed - change, min(self.speed + change, wanted))
        self.x_m += self.speed * seconds

    def next_state(self, person_m: float) -> str:
        if self.x_m >= self.goal_m:
            return "arrived"
        if person_m < self.stop_m:
            return "wait"
        return "slow" if person_m < self.slow_m else "drive"

    def drive(self) -> float:
        return 1.0

    def slow(self) -> float:
        return 0.4

    def wait(self) -> float:
        return 0.0

    arrived = wait


class BrakesLate(Base):
    """The base with a planted fault."""

    stop_m = 0.6
    slow_m = 0.6
