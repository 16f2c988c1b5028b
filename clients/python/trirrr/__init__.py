"""Client for trirrr machines: the line of docs/wire.md, in Python's standard library alone.

    frames, cobs, postcard   bytes on the line and values in them
    messages, schema         what is said, and the key of it
    exchange, stream         one request at a time; a whole job
    goals                    poses to go to, steps, velocities, poses to follow
    jobs                     moves from a scene file or a CSV table
    ports                    serial (needs pyserial) and TCP
    record, plot             telemetry as CSV and SVG
    study                    parts of a design study over any executor
"""

PROTOCOL = 4
