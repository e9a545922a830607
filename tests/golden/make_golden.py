#!/usr/bin/env python3
"""Golden values of the method for a tiny fixed network, in double precision: writes golden.json beside itself.

Run `python3 tests/golden/make_golden.py` with PyTorch (benches/peer/requirements.txt) and NumPy. Everything is written
out directly, without a transform, a cut-off or a fold, so that the engine is compared with the definition and not with
another fast path. Regenerating is legitimate only when a definition changes; the file must then differ for that reason.
"""

import json
import math
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as functional

CHANNELS = 6
KERNEL = 7
STRIDES = (1, 1, 2, 2)
EPSILON = 1e-5
FREQUENCY = 1.5
GRAM_WEIGHT = 0.08
CORRELATION_WEIGHT = 1.0
SEED = 5

SCHEMA = {
    "units": "exemplar units: the longer side of the exemplar is 1; x to the right, y to the next row",
    "grid": "[rows, columns]; the centre of pixel (row, column) is ((column + 0.5) pitch, (row + 0.5) pitch)",
    "weights": "weights[layer][c_out][c_in][row][column], cross-correlation as in every deep-learning library; "
    "the first layer takes the 5 distinct maps",
    "strides": "of the four convolutions; an output side is ceil(side / stride); padding 3 on every side, zeros when "
    "open, wrapped when periodic; no bias",
    "after_each_convolution": "instance normalisation over rows and columns (biased variance, epsilon), then ReLU",
    "channel_order": "Gaussian, then its product with cos(2 pi f dy), cos(2 pi f dx), cos(2 pi f (dx + dy)), "
    "cos(2 pi f (dx - dy)), where (dx, dy) = point - pixel",
    "maps": "map_scale times the sum over all points, without cut-off; periodic: over the images -2 ... 2 of each "
    "point in x and y, each with its own Gaussian and cosine",
    "maps_exemplar": "[channel][row][column]",
    "features_4_exemplar, features_4_output": "[channel][row][column] after the fourth ReLU",
    "digests": "of whole tensors, row-major: mean, mean of squares, and ramp = mean of value (index + 1) / count",
    "gram_exemplar, gram_output": "for layers 2, 3, 4: F F^T / (channels rows columns), [channel][channel]",
    "correlation_exemplar, correlation_output": "[channel][lag_y][lag_x] of layer 4: sum of F(x) F(x + lag), divided by "
    "(rows - |lag_y|) (columns - |lag_x|) when open and by rows columns when periodic, where x + lag wraps; the lags "
    "of a side of n are -(n div 2) ... (n - 1) div 2",
    "lags": "[n_y, n_x]: rows and columns of the exemplar's layer 4, when periodic at most those of the output's",
    "loss": "gram: for layers 2, 3, 4, gram_weight times the sum of squared differences; correlation: "
    "correlation_weight times the mean of squared differences over channels and lags; total: their sum",
    "gradient_gram, gradient_correlation, gradient": "of the Gram terms, of the correlation term and of the total with "
    "respect to every output position, [point][x, y]",
}


def gabor_maps(points, grid, case):
    """The five distinct maps, [5, rows, columns]."""
    rows, columns = grid
    pitch, sigma = case["pitch"], case["sigma"]
    x = (torch.arange(columns, dtype=torch.float64) + 0.5) * pitch
    y = (torch.arange(rows, dtype=torch.float64) + 0.5) * pitch
    images = range(-2, 3) if case["boundary"] == "periodic" else range(1)
    total = torch.zeros(5, rows, columns, dtype=torch.float64)
    omega = 2 * math.pi * case["frequency"]
    for image_y in images:
        for image_x in images:
            dx = (points[:, 0] + image_x * columns * pitch)[:, None, None] - x[None, None, :]
            dy = (points[:, 1] + image_y * rows * pitch)[:, None, None] - y[None, :, None]
            gaussian = torch.exp(-(dx**2 + dy**2) / (2 * sigma**2))
            waves = (torch.ones_like(gaussian), torch.cos(omega * dy), torch.cos(omega * dx))
            waves += (torch.cos(omega * (dx + dy)), torch.cos(omega * (dx - dy)))
            total = total + torch.stack([(gaussian * wave).sum(dim=0) for wave in waves])
    return case["map_scale"] * total


def features(maps, weights, boundary):
    """What layers 1 to 4 answer, each [channels, rows, columns]."""
    layers = []
    current = maps[None]
    for weight, stride in zip(weights, STRIDES):
        mode = "circular" if boundary == "periodic" else "constant"
        padded = functional.pad(current, (KERNEL // 2,) * 4, mode=mode)
        answer = functional.conv2d(padded, weight, stride=stride)
        mean = answer.mean(dim=(2, 3), keepdim=True)
        variance = ((answer - mean) ** 2).mean(dim=(2, 3), keepdim=True)
        current = torch.relu((answer - mean) / torch.sqrt(variance + EPSILON))
        layers.append(current[0])
    return layers


def gram(layer):
    flat = layer.reshape(layer.shape[0], -1)
    return flat @ flat.T / layer.numel()


def correlation(layer, lags, boundary):
    """Autocorrelation of every channel at the central lags, [channels, n_y, n_x]."""
    _, rows, columns = layer.shape
    table = []
    for lag_y in range(-(lags[0] // 2), (lags[0] - 1) // 2 + 1):
        line = []
        for lag_x in range(-(lags[1] // 2), (lags[1] - 1) // 2 + 1):
            if boundary == "periodic":
                moved = torch.roll(layer, shifts=(-lag_y, -lag_x), dims=(1, 2))
                line.append((layer * moved).sum(dim=(1, 2)) / (rows * columns))
                continue
            here = layer[:, max(0, -lag_y) : rows - max(0, lag_y), max(0, -lag_x) : columns - max(0, lag_x)]
            there = layer[:, max(0, lag_y) : rows - max(0, -lag_y), max(0, lag_x) : columns - max(0, -lag_x)]
            line.append((here * there).sum(dim=(1, 2)) / ((rows - abs(lag_y)) * (columns - abs(lag_x))))
        table.append(torch.stack(line, dim=-1))
    return torch.stack(table, dim=-2)


def statistics(points, grid, weights, case):
    maps = gabor_maps(points, grid, case)
    layers = features(maps, weights, case["boundary"])
    return {"maps": maps, "layers": layers, "gram": [gram(layer) for layer in layers[1:]]}


def losses(output, exemplar, lags, boundary):
    terms = [GRAM_WEIGHT * ((a - b) ** 2).sum() for a, b in zip(output["gram"], exemplar["gram"])]
    difference = correlation(output["layers"][3], lags, boundary) - correlation(exemplar["layers"][3], lags, boundary)
    return terms, CORRELATION_WEIGHT * (difference**2).mean()


def digest(tensor):
    flat = tensor.detach().reshape(-1)
    ramp = torch.arange(1, flat.numel() + 1, dtype=torch.float64) / flat.numel()
    values = (flat.mean(), (flat**2).mean(), (flat * ramp).mean())
    return dict(zip(("mean", "mean_square", "ramp"), (rounded(value) for value in values)))


def rounded(value):
    """The value as nested lists, to 13 significant digits."""
    if isinstance(value, torch.Tensor):
        value = value.detach().tolist()
    if isinstance(value, list):
        return [rounded(entry) for entry in value]
    return float(f"{value:.13g}")


def scatter(generator, count, width, height):
    """Points in the rectangle, with four digits."""
    positions = generator.uniform((0.0, 0.0), (width, height), size=(count, 2))
    return np.clip(np.round(positions, 4), 0.0, (width, height))


def check_gradient(total, points, gradient):
    """Central differences at every coordinate: a wrong fixture is worse than none.

    Fails as well when a ReLU switches within the step; SEED is one for which none does, so that single precision sees
    the same branches.
    """
    step = 1e-5
    for index in range(points.shape[0]):
        for axis in range(2):
            moved = points.clone()
            moved[index, axis] += step
            above = total(moved)
            moved[index, axis] -= 2 * step
            estimate = float(above - total(moved)) / (2 * step)
            exact = float(gradient[index, axis])
            assert abs(estimate - exact) < 1e-6 * float(gradient.abs().max()), (index, axis, estimate, exact)


def make_case(name, boundary, exemplar_grid, output_grid, sigma, generator, weights):
    pitch = 1.0 / max(exemplar_grid)
    points = {}
    for side, grid, count in (("exemplar", exemplar_grid, 6), ("output", output_grid, 14)):
        points[side] = torch.from_numpy(scatter(generator, count, grid[1] * pitch, grid[0] * pitch))
    case = {
        "name": name,
        "boundary": boundary,
        "pitch": pitch,
        "sigma": sigma,
        "frequency": FREQUENCY,
        "map_scale": 1.0 / min(30, len(points["exemplar"])),
        "gram_weight": GRAM_WEIGHT,
        "correlation_weight": CORRELATION_WEIGHT,
        "grid_exemplar": list(exemplar_grid),
        "grid_output": list(output_grid),
    }
    exemplar = statistics(points["exemplar"], exemplar_grid, weights, case)
    lags = list(exemplar["layers"][3].shape[1:])

    positions = points["output"].clone().requires_grad_(True)
    output = statistics(positions, output_grid, weights, case)
    if boundary == "periodic":
        lags = [min(pair) for pair in zip(lags, output["layers"][3].shape[1:])]
    gram_terms, correlation_term = losses(output, exemplar, lags, boundary)
    total = sum(gram_terms) + correlation_term
    (gradient_gram,) = torch.autograd.grad(sum(gram_terms), positions, retain_graph=True)
    (gradient_correlation,) = torch.autograd.grad(correlation_term, positions)
    gradient = gradient_gram + gradient_correlation

    def total_at(moved):
        with torch.no_grad():
            terms, last = losses(statistics(moved, output_grid, weights, case), exemplar, lags, boundary)
            return sum(terms) + last

    check_gradient(total_at, points["output"], gradient)

    sides = {"exemplar": exemplar, "output": output}
    case["lags"] = lags
    for side, positions_of_side in points.items():
        case[f"positions_{side}"] = positions_of_side.tolist()
    case["maps_exemplar"] = rounded(exemplar["maps"])
    for side, values in sides.items():
        digests = {"maps": digest(values["maps"])}
        digests |= {f"features_{number}": digest(layer) for number, layer in enumerate(values["layers"], start=1)}
        case[f"digests_{side}"] = digests
        case[f"features_4_{side}"] = rounded(values["layers"][3])
        case[f"gram_{side}"] = [rounded(matrix) for matrix in values["gram"]]
        case[f"correlation_{side}"] = rounded(correlation(values["layers"][3], lags, boundary))
    case["loss"] = {
        "gram": [rounded(term) for term in gram_terms],
        "correlation": rounded(correlation_term),
        "total": rounded(total),
    }
    case["gradient_gram"] = rounded(gradient_gram)
    case["gradient_correlation"] = rounded(gradient_correlation)
    case["gradient"] = rounded(gradient)
    return case


def one_key_a_line(value, indent=""):
    """JSON whose objects are spread over lines and whose arrays of numbers are not."""
    inner = indent + " "
    if isinstance(value, dict):
        lines = [f"{inner}{json.dumps(key)}: {one_key_a_line(entry, inner)}" for key, entry in value.items()]
        return "{\n" + ",\n".join(lines) + f"\n{indent}}}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(inner + one_key_a_line(entry, inner) for entry in value) + f"\n{indent}]"
    return json.dumps(value, separators=(",", ":"))


def main():
    torch.set_default_dtype(torch.float64)
    generator = np.random.default_rng(SEED)
    weights = []
    for inputs in (5, CHANNELS, CHANNELS, CHANNELS):
        bound = math.sqrt(6 / ((inputs + CHANNELS) * KERNEL**2))
        draws = generator.uniform(-bound, bound, size=(CHANNELS, inputs, KERNEL, KERNEL))
        # Four digits are exact in the file and leave the network what it is: fixed.
        weights.append(torch.from_numpy(np.round(draws, 4)))
    cases = [
        make_case("open", "open", (16, 16), (24, 32), 0.11, generator, weights),
        make_case("periodic", "periodic", (16, 16), (24, 32), 0.11, generator, weights),
        make_case("open, odd sides, not square", "open", (14, 18), (22, 27), 0.09, generator, weights),
    ]
    fixture = {
        "made_by": "tests/golden/make_golden.py",
        "schema": SCHEMA,
        "epsilon": EPSILON,
        "strides": list(STRIDES),
        "weights": [weight.tolist() for weight in weights],
        "cases": cases,
    }
    target = Path(__file__).with_name("golden.json")
    target.write_text(one_key_a_line(fixture) + "\n", encoding="utf-8")
    for case in cases:
        print(case["name"], case["loss"], "largest gradient", max(abs(v) for row in case["gradient"] for v in row))
    print(f"{target.name}: {target.stat().st_size} bytes")


if __name__ == "__main__":
    main()
