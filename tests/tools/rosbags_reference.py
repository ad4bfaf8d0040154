#!/usr/bin/env python3
"""Holds what `frames-lint collect --full` reads of recordings against PyPI's `rosbags`.

    pip install rosbags
    tests/tools/rosbags_reference.py PROGRAM FOLDER...

Compared are, for each topic, the type, the number of messages, the first and last log time, and, where rosbags can decode the messages, the
frames of headers with their counts and the first stamp. A recording that rosbags refuses is said, and compared with nothing.
"""

import collections
import json
import pathlib
import subprocess
import sys
import tempfile

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore


def recordings(folder):
    """Single files, and folders of rosbag2."""
    folders = {path.parent for path in folder.rglob("metadata.yaml")}
    yield from sorted(folders)
    for path in sorted(folder.rglob("*")):
        if path.suffix in {".bag", ".mcap", ".db3"} and path.parent not in folders and path.is_file():
            yield path


def theirs(path):
    """Per topic: type, count, first and last log time, header frames, first stamp; frames are `None` where nothing was decoded."""
    topics = {}
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        for connection, time, raw in reader.messages():
            kind = connection.msgtype.replace("/msg/", "/")
            topic = topics.setdefault(
                connection.topic, {"type": kind, "count": 0, "first": time, "last": time, "frames": collections.Counter(), "stamp": None}
            )
            topic["count"] += 1
            topic["first"], topic["last"] = min(topic["first"], time), max(topic["last"], time)
            if topic["frames"] is None:
                continue
            try:
                message = reader.deserialize(raw, connection.msgtype)
            except Exception:
                topic["frames"] = None
                continue
            header = getattr(message, "header", None)
            if header is not None and hasattr(header, "frame_id"):
                topic["frames"][header.frame_id] += 1
                if topic["stamp"] is None:
                    topic["stamp"] = header.stamp.sec * 10**9 + header.stamp.nanosec
    return topics


def ours(program, path):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "evidence.json"
        subprocess.run([program, "collect", "--full", str(path), "-o", str(out)], check=False, capture_output=True)
        document = json.loads(out.read_bytes())
    topics = {}
    for bag in (bag for world in document["worlds"] for bag in world["bags"]):
        for name, topic in bag["topics"].items():
            frames = collections.Counter({frame: use["count"] for frame, use in topic["header_frames"].items()})
            stamps = topic["stamps"]["samples"] if topic["stamps"] else []
            topics[name] = {
                "type": topic["message_type"].replace("/msg/", "/"),
                "count": topic["count"],
                "first": topic["first_log_ns"],
                "last": topic["last_log_ns"],
                "frames": frames,
                "stamp": stamps[0][0] if stamps else None,
                "read": topic["unread"] is None and not topic["malformed"],
            }
    return topics


def compare(program, path):
    try:
        their = theirs(path)
    except Exception as error:
        return None, f"rosbags refuses it: {type(error).__name__}: {error}"
    our, faults = ours(program, path), []
    for name in sorted(their.keys() | our.keys()):
        one, other = our.get(name), their.get(name)
        if one is None or other is None:
            if (one or other)["count"]:
                faults.append(f"{name}: only {'rosbags' if one is None else 'frames-lint'} has it")
            continue
        for key in ("type", "count", "first", "last"):
            if one[key] != other[key]:
                faults.append(f"{name}: {key} {one[key]}, rosbags {other[key]}")
        if other["frames"] and one["read"]:
            for key in ("frames", "stamp"):
                if one[key] != other[key]:
                    faults.append(f"{name}: {key} {one[key]}, rosbags {other[key]}")
    return faults, f"{len(their)} topics, {sum(topic['count'] for topic in their.values())} messages"


def main():
    program, *folders = sys.argv[1:]
    compared, refused, differing = 0, 0, 0
    for path in (path for folder in folders for path in recordings(pathlib.Path(folder))):
        faults, words = compare(program, path)
        compared += faults is not None
        refused += faults is None
        differing += bool(faults)
        print(f"{path}: {words}")
        for fault in faults or []:
            print(f"  {fault}")
    print(f"{compared} recordings compared, {differing} of them differ; rosbags refuses {refused}")
    sys.exit(bool(differing))


main()
