"""Every message of the protocol as a frozen record: SI units, world frame unless a name says otherwise.

A message travels as a MessagePack map with exactly these fields. A field without a default is required, an unknown
field is refused, and every number must be finite.
"""
