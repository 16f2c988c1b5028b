"""Watches the machines of a fleet, and moves one of them: `python watch_and_jog.py left`. Needs eclipse-zenoh."""

import json
import sys
import time

import zenoh

NAME = sys.argv[1]
CLIENT = "example"


def ask(net, verb, **arguments):
    """Returns the machine's answer; asks again under the same number until there is one: it is executed once."""
    payload = json.dumps({"client": CLIENT, **arguments})
    while True:
        for reply in net.get(f"trirrr/{NAME}/command/{verb}", payload=payload, timeout=2.0):
            if reply.ok:
                return json.loads(reply.ok.payload.to_string())


config = zenoh.Config.from_json5('{mode: "client", connect: {endpoints: ["tcp/127.0.0.1:7447"]}}')
with zenoh.open(config) as net:
    for reply in net.get("trirrr/*/state"):
        print(reply.ok.key_expr, json.loads(reply.ok.payload.to_string())["text"])
    token = net.liveliness().declare_token(f"trirrr/{NAME}/control/{CLIENT}")
    hello = ask(net, "hello")
    seq = hello["next_seq"]
    for verb, arguments in [("take", {"lease_s": 5}), ("enable", {}), ("jog", {"dx_m": 0.01}), ("jog", {"dy_m": 0.01})]:
        while True:  # A machine that is on its way refuses the next jog: ask again, under another number.
            answer = ask(net, verb, session=hello["session"], seq=seq, **arguments)
            seq += 1
            if answer["outcome"] == "accepted" or not answer["text"].startswith("not while"):
                break
        print(verb, answer["outcome"], answer["text"] or "")
    while (state := ask(net, "status"))["motion"]:  # Without its client the machine would come to rest on its way.
        time.sleep(0.1)
    print(state["text"], state["pose"])
