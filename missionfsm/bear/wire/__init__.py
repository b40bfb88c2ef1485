"""The messages of the API as typed values, and how they look as protobuf JSON.

Of the house it imports the kernel's texts, codes, errors and schemas alone. Begin with `missionfsm.bear.wire.messages`.
"""
