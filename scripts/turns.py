"""The turns of tests for the GPU: software Vulkan compiles kernels for minutes, so each test runs on one of several days."""

import os
import time
from zlib import crc32

# The number of days on which the tests take turns. All run with ROCKFALL_SEEDS=all.
DAYS = 8


def is_of_another_day(turn):
    """Whether tests with this name of a turn run on another day. ROCKFALL_SEEDS may be the number of a day."""
    day = os.environ.get("ROCKFALL_SEEDS") or int(time.time()) // 86400
    return day != "all" and crc32(turn.encode()) % DAYS != int(day) % DAYS
