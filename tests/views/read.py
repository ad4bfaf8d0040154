"""Reads a recording of views back with the viewer's own library, and writes what it holds as JSON.

    python read.py views.rrd
"""

import json
import sys
from datetime import datetime, timezone

import rerun
from rerun.experimental import RrdReader

entities = {}
for chunk in RrdReader(sys.argv[1]).stream():
    entity = entities.setdefault(
        str(chunk.entity_path), {"rows": 0, "static": False, "timelines": [], "components": [], "last": {}}
    )
    batch = chunk.to_record_batch()
    entity["rows"] += chunk.num_rows
    entity["static"] |= chunk.is_static
    entity["timelines"] = sorted(set(entity["timelines"]) | set(chunk.timeline_names))
    for name, column in zip(batch.schema.names, batch.columns):
        if ":" not in name:
            continue
        entity["components"] = sorted(set(entity["components"]) | {name})
        values = column.to_pylist()
        if name.split(":")[0] in {"Transform3D", "TextLog", "Points3D", "Scalars"} and values:
            last = values[-1]
            entity["last"][name] = last[:3] if isinstance(last, list) else last
    times = [batch.column(name).cast("int64").to_pylist() for name in chunk.timeline_names]
    if times and times[0]:
        first = datetime.fromtimestamp(times[0][0] / 1e9, tz=timezone.utc).isoformat()
        entity["first_time"] = min(first, entity.get("first_time", first))
json.dump({"version": rerun.__version__, "entities": entities}, sys.stdout, default=str)
