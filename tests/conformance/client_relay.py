"""Stands between the kit and a client and spoils one thing that the client says: client_relay.py HOW ADDRESS COMMAND, the command with {here} for the address."""
import socket
import struct
import subprocess
import sys
import threading

ACK, CLOCK_REQUEST, GOODBYE = 5, 4, 9  # tags of ClientBody


def field(payload, table, number):
    """Where a field of a table lies; 0 where it is absent."""
    vtable = table - struct.unpack_from("<i", payload, table)[0]
    at = 4 + 2 * number
    place = struct.unpack_from("<H", payload, vtable + at)[0] if at < struct.unpack_from("<H", payload, vtable)[0] else 0
    return table + place if place else 0


def body(payload):
    """The tag of a client's message, and where its table lies."""
    root = struct.unpack_from("<I", payload)[0]
    at = field(payload, root, 2)
    return payload[field(payload, root, 1)], at + struct.unpack_from("<I", payload, at)[0]


def no_goodbye(payload):
    return None if body(payload)[0] == GOODBYE else payload


def flipped(payload, tag, number):
    its, table = body(payload)
    at = field(payload, table, number)
    if its != tag or not at:
        return payload
    return payload[:at] + bytes([payload[at] ^ 1]) + payload[at + 1:]


def same_sequence(payload):
    tag, table = body(payload)
    at = field(payload, table, 0)
    return payload[:at] + struct.pack("<I", 1) + payload[at + 4:] if tag == CLOCK_REQUEST and at else payload


HOW = {"no-goodbye": no_goodbye, "other-hash": lambda p: flipped(p, ACK, 1), "other-answer": lambda p: flipped(p, ACK, 4),
       "same-sequence": same_sequence}


def pass_on(client, server):
    """What the server says, as it is."""
    try:
        while data := server.recv(65536):
            client.sendall(data)
        client.shutdown(socket.SHUT_WR)
    except OSError:
        pass


def relay(client, address, change):
    host, port = address.split(":")
    with client, socket.create_connection((host, int(port))) as server:
        threading.Thread(target=pass_on, args=(client, server), daemon=True).start()
        stream = client.makefile("rb")
        server.sendall(stream.read(8))
        while header := stream.read(8):
            payload = change(stream.read(struct.unpack("<I", header[:4])[0]))
            if payload is not None:
                server.sendall(header + payload)


def main():
    how, address, command = sys.argv[1:]
    with socket.create_server(("127.0.0.1", 0)) as gate:
        mine = f"127.0.0.1:{gate.getsockname()[1]}"
        subprocess.Popen(["/bin/sh", "-c", command.replace("{here}", mine)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                         stderr=subprocess.DEVNULL)
        while True:
            client, _ = gate.accept()
            try:
                relay(client, address, HOW[how])
            except OSError:
                pass


if __name__ == "__main__":
    main()
