"""Every message of the protocol: one frozen record each, SI units, world frame unless a name says otherwise.

Each travels as a MessagePack map with exactly these fields. A name without a default is required, an unknown one is
refused, and every number must be finite.
"""
