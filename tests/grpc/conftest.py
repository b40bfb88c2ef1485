"""Without the extra ``grpc``, which the extra ``test`` brings along, there is nothing here to test."""

from importlib.util import find_spec

collect_ignore_glob = [] if find_spec("grpc_reflection") else ["test_*.py"]
