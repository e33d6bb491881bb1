"""Simulators in the process of the tests compute what those in processes of their own do."""

import os

from legpush.one_thread import ONE_THREAD

os.environ.update(ONE_THREAD)
