"""tests/python/rows.py [ROWS]: measures how long a series of many rows takes to become an array, alone and with all else.

It writes a log of two topics with so many messages each (default 10,000,000), in chunks of their own, reads the one, then
both, each in a process of its own, and prints time and memory. PYTHONPATH has to name the module.
"""

import resource
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy as np

MESSAGE = np.dtype([("kind", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("logged", "<u8"),
                    ("published", "<u8"), ("header", "<u4"), ("data", "<f8")])
IN_CHUNK = 50_000  # [messages]


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def record(kind, body):
    return struct.pack("<BQ", kind, len(body)) + body


def messages(channel, first, count):
    """Rows of a topic, one a microsecond: their records."""
    rows = np.zeros(count, MESSAGE)
    numbers = np.arange(first, first + count)
    rows["kind"], rows["size"], rows["channel"] = 5, MESSAGE.itemsize - 9, channel
    rows["sequence"] = numbers
    rows["logged"] = rows["published"] = numbers * 1000
    rows["header"] = 0x100  # CDR, little endian
    rows["data"] = np.sin(1e-3 * numbers) + channel
    return rows


def write_log(file, count, topics=("/motor/current", "/battery/voltage"), unreadable=None):
    """A log in MCAP whose chunks have messages of one topic each; those of the topic `unreadable` aren't of its type."""
    schema = record(3, struct.pack("<H", 1) + text("std_msgs/msg/Float64") + text("ros2msg") + text("float64 data\n"))
    channels = [record(4, struct.pack("<HH", number, 1) + text(topic) + text("cdr") + struct.pack("<I", 0))
                for number, topic in enumerate(topics)]
    chunks, index = 0, b""
    with open(file, "wb") as out:
        out.write(b"\x89MCAP0\r\n" + record(1, text("ros2") + text("rows")) + schema + b"".join(channels))
        for first in range(0, count, IN_CHUNK):
            for channel in range(len(topics)):
                rows = messages(channel, first, min(IN_CHUNK, count - first))
                if topics[channel] == unreadable:
                    rows["header"] = 0xFFFFFFFF
                data, times = rows.tobytes(), rows["logged"]
                span = struct.pack("<QQ", times[0], times[-1])
                begin = out.tell()
                head = span + struct.pack("<QI", len(data), zlib.crc32(data)) + text("") + struct.pack("<Q", len(data))
                chunks += 1
                out.write(record(6, head + data))
                at = out.tell()
                places = np.zeros(len(rows), [("time", "<u8"), ("offset", "<u8")])
                places["time"], places["offset"] = times, np.arange(len(rows)) * MESSAGE.itemsize
                out.write(record(7, struct.pack("<HI", channel, places.nbytes) + places.tobytes()))
                index += record(8, span + struct.pack("<QQIHQQ", begin, at - begin, 10, channel, at, out.tell() - at)
                                + text("") + struct.pack("<QQ", len(data), len(data)))
        out.write(record(15, struct.pack("<I", 0)))
        summary = out.tell()
        counts = b"".join(struct.pack("<HQ", channel, count) for channel in range(len(topics)))
        out.write(schema + b"".join(channels) + index)
        out.write(record(11, struct.pack("<QHIIIIQQ", count * len(topics), 1, len(topics), 0, 0, chunks, 0,
                                         (count - 1) * 1000) + struct.pack("<I", len(counts)) + counts))
        out.write(record(2, struct.pack("<QQI", summary, 0, 0)) + b"\x89MCAP0\r\n")


def measure(file, *topics):
    import rehearse

    before = time.monotonic()
    trace = rehearse.Trace(file, topics=list(topics) or None)
    array = trace["motor/data"]
    seconds = time.monotonic() - before
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(f"{' '.join(topics) or 'all topics'}: {len(array)} rows in {seconds:.2f} s, {megabytes:.0f} MB at most")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        measure(*sys.argv[2:])
    else:
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "rows.mcap"
            write_log(log, int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000)
            print(f"a log of {log.stat().st_size / 1e6:.0f} MB")
            for words in (["/motor/current"], []):
                subprocess.run([sys.executable, __file__, "--measure", str(log), *words], check=True)
