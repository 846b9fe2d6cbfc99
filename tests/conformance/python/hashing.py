"""The hash of the standard: 64-bit FNV-1a."""


def fnv(data, value=0xCBF29CE484222325):
    """The hash of bytes, going on from an earlier hash."""
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value
