"""The Bear API over gRPC: descriptors at run time, the reference as a server, a server as a subject, a proxy between.

They import the kernel and the messages of `missionfsm.bear.wire`, and need the extra ``grpc``. Begin with
`descriptors`: everything else speaks in its messages.
"""
