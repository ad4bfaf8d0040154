#!/usr/bin/env python3
"""Compares the points that `frames-lint collect --clouds` decodes of an Ouster's packets and OSF files with those of PyPI's `ouster-sdk`.

    pip install ouster-sdk
    tests/tools/ouster_reference.py PROGRAM FOLDER...

Captures are decoded by the JSON files beside them. Both clouds are expressed in the sensor frame. A cloud is compared with the frames that have as
many points; each point must have one of the same beam within 2 mm and 10 microseconds.
"""

import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

import numpy as np
import ouster.sdk.core as core
from ouster.sdk import osf

MOST_M, MOST_S = 0.002, 1e-5
# x, y, z, intensity, ring, time.
OURS = np.dtype([("place", "<f4", 3), ("intensity", "<f4"), ("ring", "<u2"), ("time", "<f8")])
# Bytes before the IP header by the type of the link: Ethernet, and Linux "cooked".
LINKS = {1: 14, 113: 16, 276: 20}


def payloads(path):
    """The UDP payloads of a pcap file; IPv4 fragments are put together."""
    data = path.read_bytes()
    skip = LINKS[struct.unpack_from("<I", data, 20)[0]]
    at, parts = 24, {}
    while at + 16 <= len(data):
        length = struct.unpack_from("<I", data, at + 8)[0]
        ip = data[at + 16 + skip : at + 16 + length]
        at += 16 + length
        if len(ip) < 20 or ip[0] >> 4 != 4 or ip[9] != 17:
            continue
        total, number, flags = struct.unpack_from(">HHH", ip, 2)
        key = (ip[12:20], number)
        pieces = parts.setdefault(key, {})
        pieces[8 * (flags & 0x1FFF)] = (ip[4 * (ip[0] & 15) : total], bool(flags & 0x2000))
        whole, offset = b"", 0
        while offset in pieces:
            piece, more = pieces[offset]
            whole += piece
            offset += len(piece)
            if not more:
                del parts[key]
                yield whole[8:]
                break


def points(frame, table):
    """The returns of a frame: place, beam, time in nanoseconds. A second return that repeats the first is none."""
    first = frame.field("RANGE")
    echoes = [(first, first > 0)]
    if frame.has_field("RANGE2"):
        second = frame.field("RANGE2")
        echoes.append((second, (second > 0) & (second != first)))
    valid = (frame.status & 1 == 1)[None, :]
    found = []
    for ranges, keep in echoes:
        row, column = np.nonzero(keep & valid)
        found.append((table(ranges)[row, column], row, frame.timestamp[column].astype(np.int64)))
    return tuple(np.concatenate(part) for part in zip(*found))


def of_capture(path, text):
    """The frames of a capture by a sensor's metadata."""
    info = core.SensorInfo(text)
    form = core.PacketFormat.from_info(info)
    is_legacy = info.format.udp_profile_lidar == core.UDPProfileLidar.LEGACY
    frames = {}
    for payload in payloads(path):
        if len(payload) != form.lidar_packet_size:
            continue
        buffer = np.frombuffer(payload, np.uint8)
        if not is_legacy and (form.packet_type(buffer) != 1 or (info.sn and form.prod_sn(buffer) not in (0, info.sn))):
            continue
        frames.setdefault(form.frame_id(buffer), []).append(buffer)
    kinds = [
        core.FieldType(name, form.packet_field(name, np.zeros(form.lidar_packet_size, np.uint8)).dtype.type)
        for name in form.fields
        if name in ("RANGE", "RANGE2")
    ]
    for buffers in frames.values():
        # A sensor that was started again is the same.
        info.init_id = form.init_id(buffers[0])
        frame, batch = core.LidarFrame(info, kinds), core.FrameBatcher(info)
        for buffer in buffers:
            packet = core.LidarPacket(form)
            packet.buf[:] = buffer
            packet.host_timestamp = 1
            batch.batch(packet, frame)
        yield points(frame, core.XYZLut(info, False))


def of_osf(path):
    """The frames of an OSF file."""
    reader = osf.Reader(str(path))
    sensors = {number: meta.info for number, meta in reader.meta_store.find(osf.LidarSensor).items()}
    streams = {number: meta.sensor_meta_id for number, meta in reader.meta_store.find(osf.LidarFrameStream).items()}
    for message in reader.messages():
        if message.id in streams:
            yield points(message.decode(), core.XYZLut(sensors[streams[message.id]], False))


def collected(program, path):
    """The program's cloud of each topic, by topic: points, or why there are none."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.pcd"

        def cloud(*more):
            out.unlink(missing_ok=True)
            ran = subprocess.run([program, "collect", path, "--clouds", out, *more], check=False, capture_output=True, text=True)
            return np.frombuffer(out.read_bytes().split(b"DATA binary\n", 1)[1], OURS) if out.exists() else ran.stderr.strip()

        one = cloud()
        topics = re.findall("`(/[^`]*/[^`]*:[0-9]+)`", one) if isinstance(one, str) else []
        return {topic: cloud("--topic", topic) for topic in topics} or {"": one}


def difference(our, their):
    """The largest distance in metres and in time in seconds between two clouds, point by point."""
    place, row, time_ns = their
    time_s = (time_ns - time_ns.min()) * 1e-9
    our_s = our["time"] - our["time"].min()
    # Columns are thousands of nanoseconds apart; the points of one beam and column differ in range alone.
    theirs = np.lexsort((np.linalg.norm(place, axis=1), time_ns, row))
    ours = np.lexsort((np.linalg.norm(our["place"], axis=1), np.round(our_s * 1e6), our["ring"]))
    if not np.array_equal(our["ring"][ours], row[theirs]):
        return np.inf, np.inf
    off = np.linalg.norm(our["place"][ours] - place[theirs], axis=1)
    return off.max(), np.abs(our_s[ours] - time_s[theirs]).max()


def frames_of(path):
    """The frames with a point that ouster-sdk decodes of a file; of a capture, by each metadata whose name begins most like its own."""
    if path.suffix == ".osf":
        return [frame for frame in of_osf(path) if len(frame[1])]
    alike = {json: len(os.path.commonprefix([json.stem, path.stem])) for json in sorted(path.parent.glob("*.json"))}
    frames, whys = [], []
    for json in (json for json, letters in alike.items() if letters == max(alike.values())):
        try:
            frames += [frame for frame in of_capture(path, json.read_text()) if len(frame[1])]
        except Exception as error:
            whys.append(f"{json.name}: {type(error).__name__}: {error}")
    if not frames:
        raise ValueError("; ".join(whys) or "no frame")
    return frames


def compare(program, path):
    """A line of the table for each cloud, and whether that is good; `None` where ouster-sdk decodes nothing."""
    try:
        frames = frames_of(path)
    except Exception as error:
        yield f"ouster-sdk decodes nothing: {error}", None
        return
    for topic, our in collected(program, path).items():
        if isinstance(our, str):
            yield f"{our}  {topic}", False
            continue
        alike = [difference(our, frame) for frame in frames if len(frame[1]) == len(our)]
        off_m, off_s = min(alike, default=(np.inf, np.inf))
        counts = "" if alike else f", ouster-sdk {sorted(len(frame[1]) for frame in frames)}"
        yield f"{len(our):7} points{counts} {off_m * 1000:8.4f} mm {off_s * 1e6:8.4f} us  {topic}", off_m < MOST_M and off_s < MOST_S


def main():
    program, *folders = sys.argv[1:]
    program = str(pathlib.Path(program).resolve())
    counts = {True: 0, False: 0, None: 0}
    for path in sorted(path for folder in folders for path in pathlib.Path(folder).rglob("*") if path.suffix in {".pcap", ".osf"}):
        for words, is_good in compare(program, path):
            counts[is_good] += 1
            print({True: "good", False: "BAD ", None: "none"}[is_good], words, path.name)
    print(f"{counts[True] + counts[False]} clouds compared, {counts[False]} of them differ; ouster-sdk decodes nothing of {counts[None]}")
    sys.exit(counts[False] > 0 or counts[True] == 0)


main()
