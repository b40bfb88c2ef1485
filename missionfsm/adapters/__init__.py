"""Input and output: files, pipes, processes and sockets.

They import the kernel, what is said on the wire, and what runs. Begin with `missionfsm.adapters.stdio`, which speaks
the adapter protocol with an implementation.
"""
