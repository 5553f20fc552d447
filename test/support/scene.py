"""Modules that talk to central as those of CMU IPC do, and logs made comparable."""
import re

from support.peer import Peer

#: Part of a handler's name: on the machine of the samples, the address of a function.
ADDRESS = "93901472892120"


class Actor(Peer):
    """A module that asks, announces and acknowledges in the order of the original library."""

    def __init__(self, central, name, **options):
        super().__init__(central, name, host="robot1", **options)
        self.asked = set()

    def join(self):
        return self.connect_as_original()

    def subscribe_to(self, name, handler=198):
        """Subscribes with a handler name as long as the original's."""
        self.subscribe(name, handler, f"HND-{name}{ADDRESS}")

    def ask_about(self, delivery):
        """A module asks about a message on behalf of each handler that gets it first."""
        if delivery.handler not in self.asked:
            self.asked.add(delivery.handler)
            internal = delivery.name.startswith("V_")
            self.look_up(delivery.name, delivery.name if internal
                         else f"HND-{delivery.name}{ADDRESS}")

    def handle(self, count=1, *, ask=True):
        """Takes the next deliveries one by one; returns the last one."""
        for _ in range(count):
            delivery = self.next_delivery()
            if ask:
                self.ask_about(delivery)
            self.acknowledge(delivery)
        return delivery

    def listen(self):
        """Handles the internal messages that have come, so that they are out of the way."""
        self.sync()
        while self.deliveries:
            self.handle(ask=False)
            self.sync()

    def leave(self):
        """Disconnects in order."""
        self.say_goodbye()
        assert self.is_closed()
        self.close()


def masked(text):
    """A log without what differs from run to run."""
    text = re.sub(r"Task Control Server \d+\.\d+\.\d+ \(.*?\)", "Task Control Server V", text)
    text = re.sub(r"( on )\w{3} \w{3} [ \d]\d \d\d:\d\d:\d\d \d{4}$", r"\1DATE", text,
                  flags=re.MULTILINE)
    text = re.sub(r"(on port )\d+", r"\1PORT", text)
    text = re.sub(r"(?:  \d| \d\d):\d\d:\d\d\.\d\d$", " TIME", text, flags=re.MULTILINE)
    text = re.sub(r" \{\d+\}", " {N}", text)
    text = re.sub(r"(sd: |new connection: |Capacity of )\d+", r"\1N", text)
    text = re.sub(r"\*\{\d+, \"", "*{N, \"", text)
    text = re.sub(r"\{\{3, \d+\}", "{{3, N}", text)
    text = re.sub(r"Msg: [\d.]+%, Mon: 0\.00%, Wait [\d.]+%, Msg: \((\d+), \d+\) Ave: \((\d+), \d+\)",
                  r"Msg: P, Mon: P, Wait P, Msg: (\1, T) Ave: (\2, T)", text)
    return text


def mended(text):
    """A log of the original as ours has it: every line ends, and stands alone."""
    text = re.sub(r"(pending message limit of \S+ from \d+ to \d)(?!\n)", r"\1\n", text)
    text = re.sub(r"(Transferring (\S+)(?: \{\d+\})? from Resource (\w+) to \3)(?!\n)", r"\1\n",
                  text)
    return text.replace("\n\nWARNING", "\nWARNING")
