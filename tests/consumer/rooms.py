#!/usr/bin/env python3
"""Which room includes headers of which: no two may do so in a circle. Usage: rooms.py SOURCE_FOLDER"""
import graphlib
import pathlib
import re
import sys

INCLUDE = re.compile(r'#include "rigproof/((?:calib|study)/\w+|\w+)/')
SOURCES = ["core", "sim", "generator", "calib", "validate", "study", "app", "python"]


def room_of(path):
    """calib/vision/src/observe.cpp -> calib/vision; core/formats/src/.. -> formats; generator/src/.. -> generator"""
    parts = path.parts
    if parts[0] in ("calib", "study"):
        return "/".join(parts[:2])
    nested = len(parts) > 2 and parts[1] in ("truth", "formats", "bags", "geometric")
    return parts[1] if nested else parts[0]


def includes_of(root):
    rooms = {}
    for folder in SOURCES:
        for file in (root / folder).rglob("*"):
            if file.suffix in (".h", ".cpp"):
                room = room_of(file.relative_to(root))
                rooms.setdefault(room, set()).update(INCLUDE.findall(file.read_text()))
    return {room: others - {room} for room, others in rooms.items()}


rooms = includes_of(pathlib.Path(sys.argv[1]))
if len(rooms) < 15:
    sys.exit("only these rooms were found: " + ", ".join(sorted(rooms)))
try:
    print("\n".join(graphlib.TopologicalSorter(rooms).static_order()))
except graphlib.CycleError as error:
    sys.exit("these rooms include each other in a circle: " + " -> ".join(reversed(error.args[1])))
