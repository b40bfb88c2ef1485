"""The Bear API over gRPC: descriptors at run time, the reference as a server, a server as a subject, a proxy between.

May import kernel, app's live reference and the table of the wire; needs the extra ``grpc``. Begin with `descriptors`:
everything else speaks in its messages.
"""
