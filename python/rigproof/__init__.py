"""Where is each camera on your robot, how sure are you, and prove it.

Transforms are T_target_source; metres, radians, seconds, pixels; camera frames are optical (z forward). Arrays are
copies: changing one changes nothing else. `docs/guides/python.md` begins with examples.
"""
from ._core import *  # noqa: F401,F403
from ._core import __version__  # noqa: F401
