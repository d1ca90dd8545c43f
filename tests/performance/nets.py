"""Networks by the shapes of their arrays: what an update has to move."""

from dataclasses import dataclass


@dataclass
class Net:
    """What an update has to move. An activation is written and read forward, read again
    for the weights, and its gradient is written and read: 5 times. An input is read
    twice. A parameter is read forward and backward, its gradient is written and read,
    Adam reads it and writes it with two moments: 10 times."""
    batch: int
    inputs: int
    layers: list  # (numbers that come out, parameters)

    def numbers(self):
        out, parameters = map(sum, zip(*self.layers))
        return self.batch * (2 * self.inputs + 5 * out) + 10 * parameters


def dense(*sizes):
    return [(b, a * b + b) for a, b in zip(sizes, sizes[1:])]


def conv(channels, features, positions, taps):
    return [(features * positions, taps * channels * features + features)]


def mlp(batch, *sizes):
    return Net(batch, sizes[0], dense(*sizes))


def vgg(batch, channels, positions, features, *sizes):
    layers, c, n = [], channels, positions
    for f in features:
        layers += conv(c, f, n, 3)
        c, n = f, n // 2
        layers += [(f * n, 0)]
    return Net(batch, channels * positions, layers + dense(c * n, *sizes))


def pooled(batch):
    layers, c, n = [], 1, 256
    for _ in range(5):
        n //= 2
        layers += [(c * n, 0)] + conv(c, 16, n, 3) + conv(16, 16, n, 3)
        c = 16
    return Net(batch, 256, layers + dense(16 * n, 64, 32, 1))


def unet(batch, side, channels=1, outputs=1, levels=4, f=16):
    def double(c, cells):
        return conv(c, f, cells, 9) + conv(f, f, cells, 9)
    cells = [side * side // 4 ** k for k in range(levels)]
    layers = double(channels, cells[0])
    for n in cells[1:]:
        layers += [(f * n, 0)] + double(f, n)
    for n in cells[-2::-1]:
        layers += [(f * n, 0)] + double(2 * f, n)
    return Net(batch, channels * cells[0], layers + conv(f, outputs, cells[0], 1))


def fno(batch, side=64, padding=9, width=32, modes=12, hidden=128):
    cells, padded, kept = side * side, (side + padding) ** 2, 2 * modes * modes
    block = [(2 * width * kept, 2 * width * width * kept),
             (width * padded, width * width + width)]
    return Net(batch, 3 * cells, conv(3, width, cells, 1) + 4 * block +
               conv(width, hidden, cells, 1) + conv(hidden, 1, cells, 1))
