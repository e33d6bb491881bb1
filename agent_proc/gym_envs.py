"""Former address of `legpush.gym`, which registers the environments with Gymnasium."""

from legpush.gym import PUSH_ID

__all__ = ["PUSH_ID"]
