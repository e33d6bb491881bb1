"""Reads Foxglove's MCAP files with the MCAP library and Protocol Buffers: by the schemas in the file, not our code."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader


@dataclass(frozen=True, kw_only=True)
class Read:
    """A message."""

    topic: str
    schema: str
    time_ns: int
    content: Any


def read(path: Path) -> list[Read]:
    """All messages, by time."""
    kinds: dict[str, Any] = {}
    found = []
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            if channel.message_encoding == "json":
                content = json.loads(message.data)
            else:
                if schema.name not in kinds:
                    kinds[schema.name] = _kind(schema.name, schema.data)
                content = kinds[schema.name].FromString(message.data)
            found.append(Read(topic=channel.topic, schema=schema.name, time_ns=message.log_time, content=content))
    return found


def _kind(name: str, data: bytes) -> Any:
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(data).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))
