#!/usr/bin/python3
"""Answers look-ups with the tf2 that is installed (Debian: python3-tf2), for tests/tf2_reference.rs.

Reads one request a line, answers one line each:
  new <nanoseconds>|max                              -> ok
  set <parent> <child> <ns> <x y z qx qy qz qw> <0|1> -> -   (this binding does not say whether it was refused)
  get <target> <source> <ns>                          -> pose <ns> <x y z qx qy qz qw> | fail <exception> <past|future|single|->
An empty name is written <empty>.
"""

import sys

import genpy
import tf2_py
from geometry_msgs.msg import TransformStamped

KINDS = (("into the past", "past"), ("into the future", "future"), ("but only time", "single"))


def name(word):
    return "" if word == "<empty>" else word


def time(word):
    ns = int(word)
    return genpy.Time(ns // 10**9, ns % 10**9)


def main():
    buffer = None
    for line in sys.stdin:
        verb, *words = line.split()
        if verb == "new":
            # 60 years: the longest that fits its 32 bits of seconds with room for the sum.
            seconds = 60 * 365 * 86400 if words[0] == "max" else int(words[0]) / 1e9
            buffer = tf2_py.BufferCore(genpy.Duration.from_sec(seconds))
            print("ok")
        elif verb == "set":
            transform = TransformStamped()
            transform.header.frame_id, transform.child_frame_id = name(words[0]), name(words[1])
            transform.header.stamp = time(words[2])
            numbers = [float(word) for word in words[3:10]]
            p, q = transform.transform.translation, transform.transform.rotation
            p.x, p.y, p.z, q.x, q.y, q.z, q.w = numbers
            if words[10] == "1":
                buffer.set_transform_static(transform, "test")
            else:
                buffer.set_transform(transform, "test")
            print("-")
        else:
            try:
                found = buffer.lookup_transform_core(name(words[0]), name(words[1]), time(words[2]))
                p, q = found.transform.translation, found.transform.rotation
                stamp = found.header.stamp.secs * 10**9 + found.header.stamp.nsecs
                print("pose", stamp, *(repr(v) for v in (p.x, p.y, p.z, q.x, q.y, q.z, q.w)))
            except tf2_py.TransformException as error:
                kind = next((kind for words, kind in KINDS if words in str(error)), "-")
                print("fail", type(error).__name__, kind)


main()
