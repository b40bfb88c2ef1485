"""A lift that is called and watched: a system with a queue, a stream, names and lost calls."""
