#!/usr/bin/env python3
"""One iteration of the method in PyTorch, written to be fast: the opponent of `pointweave bench`.

The same work as ours: five Gabor maps instead of ten, frozen weights, targets computed once, Gram matrices of layers
2 to 4, deep correlation of layer 4 by FFT, the true gradient back to the positions, and an Adam step. The maps are
products of an x-table and a y-table a point, so that each is one small matrix product; both memory layouts of the
convolutions are tried and the faster one is used. Prints one JSON object with --json.
"""

import argparse
import json
import math
import statistics
import time

import torch
import torch.nn.functional as functional

KERNEL = 7
STRIDES = (1, 1, 2, 2)
EPSILON = 1e-5
FREQUENCY = 1.5
GRAM_WEIGHT = 0.08
CORRELATION_WEIGHT = 1.0
LAYOUTS = {"contiguous": torch.contiguous_format, "channels_last": torch.channels_last}


class Clock:
    """Sums the seconds of named parts."""

    def __init__(self):
        self.parts = {}
        self.last = time.perf_counter()

    def lap(self, part):
        now = time.perf_counter()
        self.parts[part] = self.parts.get(part, 0.0) + now - self.last
        self.last = now


class Grid:
    """Pixel centres of a sampling grid, in exemplar units."""

    def __init__(self, rows, columns, pitch):
        self.x = (torch.arange(columns) + 0.5) * pitch
        self.y = (torch.arange(rows) + 0.5) * pitch


def gabor_maps(points, grid, sigma, scale):
    """The Gaussian and its products with the four cosines, [1, 5, rows, columns].

    cos(a + b) and cos(a - b) are products of functions of x and functions of y, and so is the Gaussian: every map is a
    product of a [rows, points] and a [points, columns] matrix, or of two stacked ones.
    """
    dx = points[:, 0:1] - grid.x[None, :]
    dy = points[:, 1:2] - grid.y[None, :]
    gauss_x = torch.exp(dx.square() * (-0.5 / sigma**2))
    gauss_y = torch.exp(dy.square() * (-0.5 / sigma**2)) * scale
    omega = 2 * math.pi * FREQUENCY
    cos_x, sin_x = gauss_x * torch.cos(omega * dx), gauss_x * torch.sin(omega * dx)
    cos_y, sin_y = gauss_y * torch.cos(omega * dy), gauss_y * torch.sin(omega * dy)
    left = torch.stack([gauss_y, cos_y, gauss_y, cos_y, sin_y]).transpose(1, 2)
    right = torch.stack([gauss_x, gauss_x, cos_x, cos_x, sin_x])
    plain, along_y, along_x, even, odd = torch.bmm(left, right)
    return torch.stack([plain, along_y, along_x, even - odd, even + odd])[None]


def layers(maps, weights, layout, clock=None):
    """Layers 2 to 4 after instance normalisation and ReLU."""
    answers = []
    current = maps.contiguous(memory_format=layout)
    for weight, stride in zip(weights, STRIDES):
        current = functional.conv2d(current, weight, stride=stride, padding=KERNEL // 2)
        current = functional.relu_(functional.instance_norm(current, eps=EPSILON))
        answers.append(current)
    if clock:
        clock.lap("convolution")
    return answers[1:]


def gram(layer):
    flat = layer[0].flatten(1)
    return flat @ flat.T / flat.numel()


class Correlation:
    """Autocorrelation of every channel at the central lags, by FFT on a padded map."""

    def __init__(self, rows, columns, lags):
        # Lags beyond the crop may wrap into each other: padding by the crop's half width is enough.
        self.size = (rows + lags[0] // 2 + 1, columns + lags[1] // 2 + 1)
        self.size = tuple(quick_length(side) for side in self.size)
        self.lags = [torch.arange(-(count // 2), (count - 1) // 2 + 1) for count in lags]
        overlap_y, overlap_x = rows - self.lags[0].abs(), columns - self.lags[1].abs()
        self.inverse_overlap = 1.0 / (overlap_y[:, None] * overlap_x[None, :])

    def __call__(self, layer):
        spectrum = torch.fft.rfft2(layer[0].contiguous(), s=self.size)
        power = torch.view_as_real(spectrum).square().sum(dim=-1)
        table = torch.fft.irfft2(torch.complex(power, torch.zeros_like(power)), s=self.size)
        # The lags -n/2 … (n - 1)/2 lie at the two ends of each axis.
        for axis, lags in enumerate(self.lags, start=1):
            below = int((lags < 0).sum())
            ends = [table.narrow(axis, table.shape[axis] - below, below), table.narrow(axis, 0, len(lags) - below)]
            table = torch.cat(ends, dim=axis)
        return table * self.inverse_overlap


def quick_length(length):
    """The next length whose only prime factors are 2, 3 and 5."""
    while True:
        rest = length
        for factor in (2, 3, 5):
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
        length += 1


def make_weights(channels, layout):
    generator = torch.Generator().manual_seed(1)
    weights = []
    for inputs in (5, channels, channels, channels):
        bound = math.sqrt(6 / ((inputs + channels) * KERNEL**2))
        weight = torch.empty(channels, inputs, KERNEL, KERNEL).uniform_(-bound, bound, generator=generator)
        weights.append(weight.contiguous(memory_format=layout).requires_grad_(False))
    return weights


class Run:
    """Everything that stays the same from one iteration to the next, and the points that move."""

    def __init__(self, arguments, layout):
        columns, rows = arguments.grid
        side = arguments.exemplar_grid
        pitch = 1.0 / side
        width, height = columns * pitch, rows * pitch
        self.layout = LAYOUTS[layout]
        self.weights = make_weights(arguments.channels, self.layout)
        exemplar_points = max(1, round(arguments.points / (width * height)))
        self.scale = 1.0 / min(30, exemplar_points)
        # About the distance between neighbours, as on the coarsest scale.
        self.sigma = 0.8 * math.sqrt(1.0 / exemplar_points)

        generator = torch.Generator().manual_seed(2)
        exemplar = torch.rand(exemplar_points, 2, generator=generator)
        start = torch.rand(arguments.points, 2, generator=generator) * torch.tensor([width, height])
        self.points = start.requires_grad_(True)
        self.grid = Grid(rows, columns, pitch)
        self.optimizer = torch.optim.Adam([self.points], lr=0.005 * max(width, height))

        with torch.inference_mode():
            maps = gabor_maps(exemplar, Grid(side, side, pitch), self.sigma, self.scale)
            answers = layers(maps, self.weights, self.layout)
            lags = answers[2].shape[2:]
            targets = [gram(layer) for layer in answers] + [Correlation(*lags, lags)(answers[2])]
        # Tensors of inference mode can't take part in a gradient; their copies can.
        *self.target_grams, self.target_correlation = [target.clone() for target in targets]
        quarter = (-(-side_length // 4) for side_length in (rows, columns))
        self.correlation = Correlation(*quarter, lags)

    def iterate(self, clock):
        clock.last = time.perf_counter()
        self.optimizer.zero_grad(set_to_none=True)
        maps = gabor_maps(self.points, self.grid, self.sigma, self.scale)
        clock.lap("features")
        answers = layers(maps, self.weights, self.layout, clock)
        loss = sum(
            GRAM_WEIGHT * (gram(layer) - target).square().sum() for layer, target in zip(answers, self.target_grams)
        )
        clock.lap("gram")
        difference = self.correlation(answers[2]) - self.target_correlation
        loss = loss + CORRELATION_WEIGHT * difference.square().mean()
        clock.lap("correlation")
        loss.backward()
        clock.lap("backward")
        self.optimizer.step()
        clock.lap("adam")
        return float(loss.detach())


def measure(run, iterations):
    """Seconds of each iteration, the mean seconds of each part and the losses."""
    clock, seconds, losses = Clock(), [], []
    for _ in range(iterations):
        start = time.perf_counter()
        losses.append(run.iterate(clock))
        seconds.append(time.perf_counter() - start)
    return seconds, {part: total / iterations for part, total in clock.parts.items()}, losses


def parse():
    def grid(text):
        columns, rows = (int(side) for side in text.split("x"))
        return columns, rows

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--grid", type=grid, default=(256, 256), metavar="COLUMNSxROWS")
    parser.add_argument("--exemplar-grid", type=int, default=128)
    parser.add_argument("--channels", type=int, default=120)
    parser.add_argument("--points", type=int, default=256)
    parser.add_argument("--iterations", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--layout", choices=["auto", *LAYOUTS], default="auto")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    return parser.parse_args()


def main():
    arguments = parse()
    torch.set_num_threads(arguments.threads)
    torch.set_num_interop_threads(1)

    names = list(LAYOUTS) if arguments.layout == "auto" else [arguments.layout]
    candidates = {}
    for name in names:
        run = Run(arguments, name)
        run.iterate(Clock())
        # After that warm-up one timed iteration decides; the layouts differ by far more than the noise.
        candidates[name] = (measure(run, 1)[0][0], run)
    layout = min(candidates, key=lambda name: candidates[name][0])
    seconds, stages, losses = measure(candidates[layout][1], arguments.iterations)

    report = {
        "seconds_per_iteration": statistics.median(seconds),
        "stages": stages,
        "layout": layout,
        "layout_seconds": {name: first for name, (first, _) in candidates.items()},
        "threads": torch.get_num_threads(),
        "iterations": arguments.iterations,
        "losses": losses,
        "torch": torch.__version__,
    }
    if arguments.json:
        print(json.dumps(report))
        return
    print(f"{report['seconds_per_iteration']:.3f} s per iteration ({layout}, PyTorch {torch.__version__})")
    for part, share in stages.items():
        print(f"  {part:<12} {share:.3f} s")


if __name__ == "__main__":
    main()
