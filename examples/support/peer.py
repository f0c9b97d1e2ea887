"""Programs of others in our tests: checks that are counted, and the line from which the table of peers is made."""
import datetime
import importlib.metadata
import sys


def version(distribution):
    return importlib.metadata.version(distribution)


class Peer:
    """`name` with its version; `end` prints how many checks held, and when, and ends the program."""

    def __init__(self, name):
        self.name, self.tried, self.held = name, 0, 0

    def check(self, holds, what):
        self.tried += 1
        self.held += bool(holds)
        if not holds:
            print("failed:", what)
        return holds

    def equal(self, found, expected, what):
        return self.check(found == expected, "%s: %r, expected %r" % (what, found, expected))

    def require(self, holds, what):
        """A check without which nothing further is told."""
        if not self.check(holds, what):
            self.end()

    def end(self):
        print("%s: %d of %d, %s" % (self.name, self.held, self.tried, datetime.date.today()), flush=True)
        sys.exit(self.held != self.tried)


def skip(package):
    print("skipped: sudo apt-get install " + package)
    sys.exit(77)
