"""What ends a session: a code of chapter 12, and the requirement that was broken."""


class Refusal(Exception):
    """A message that the standard says to refuse; code by name."""

    def __init__(self, code, requirement, message):
        super().__init__(f"{code} (R-{requirement}): {message}" if requirement else f"{code}: {message}")
        self.code, self.requirement, self.message = code, requirement, message
