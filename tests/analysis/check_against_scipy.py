"""Golden values of src/analysis: other people's code (scipy; checked against astropy and pointpats) where there is some, and plain
sums over all pairs. check_against_spatstat.R has what these lack.

    python -m venv venv && venv/bin/pip install numpy==2.4.6 scipy==1.17.1 pointpats==2.5.5 astropy==8.0.2
    venv/bin/python tests/analysis/check_against_scipy.py

writes golden.json beside itself; tests/analysis.rs compares. Rewrite it only when a definition changes.
"""

import json
import pathlib

import numpy as np
import pointpats
from astropy.stats import RipleysKEstimator
from scipy import integrate, optimize, spatial
from scipy.spatial import cKDTree

rng = np.random.default_rng(20220704)
SIZE = np.array([1.0, 0.7])


def points(count, attraction):
    """Points that are neither chance nor order, with six decimals so that JSON holds them exactly enough."""
    centers = rng.random((max(count // 5, 1), 2)) * SIZE
    spread = centers[rng.integers(len(centers), size=count)] + attraction * rng.normal(size=(count, 2))
    return np.round(np.mod(spread, SIZE), 6)


A, B = points(47, 0.08), points(61, 0.15)


def pairs(p, periodic, reach):
    """All ordered pairs' differences; on a torus with all images within reach."""
    found = []
    shifts = [(0.0, 0.0)]
    if periodic:
        shifts = [(i * SIZE[0], j * SIZE[1]) for i in range(-3, 4) for j in range(-3, 4)]
    for shift in shifts:
        difference = p[None, :, :] + np.array(shift) - p[:, None, :]
        keep = np.hypot(difference[..., 0], difference[..., 1]) <= reach
        if shift == (0.0, 0.0):
            keep &= ~np.eye(len(p), dtype=bool)
        found.append(difference[keep])
    return np.concatenate(found)


def weights(v, periodic):
    area = SIZE.prod()
    if periodic:
        return np.full(len(v), 1 / area)
    overlap = np.clip(SIZE - np.abs(v), 0, None).prod(axis=1)
    return 1 / np.maximum(overlap, 0.05 * area)


def squared_density(p, periodic):
    return len(p) * (len(p) if periodic else len(p) - 1) / SIZE.prod() ** 2


def nearest(p, k, periodic):
    found = []
    tree = cKDTree(p, boxsize=SIZE if periodic else None)
    distances, _ = tree.query(p, k=k + 1)
    found.append(distances[:, 1:])
    return found[0]


def pair_correlation(p, periodic, sigma, radii):
    v = pairs(p, periodic, radii[-1] + 8 * sigma)
    d, w = np.hypot(*v.T), weights(v, periodic)
    values = []
    for r in radii:
        kernel = np.exp(-((r - d) ** 2) / (2 * sigma**2)) / np.sqrt(2 * np.pi) / sigma
        # Four standard deviations count.
        kernel[np.abs(r - d) > 4 * sigma] = 0
        caught, _ = integrate.quad(
            lambda s: 2 * np.pi * s * np.exp(-((r - s) ** 2) / (2 * sigma**2)) / np.sqrt(2 * np.pi) / sigma,
            max(0, r - 10 * sigma),
            r + 10 * sigma,
            epsabs=1e-13,
        )
        values.append((kernel * w).sum() / caught / squared_density(p, periodic))
    return values


def pair_density(p, periodic, sigma, places):
    v = pairs(p, periodic, np.hypot(*np.abs(places).max(axis=0)) + 6 * sigma)
    w = weights(v, periodic)
    offset = places[:, None, :] - v[None]
    kernel = np.exp(-(offset**2).sum(-1) / (2 * sigma**2)) / (2 * np.pi * sigma**2)
    # Three and a half standard deviations along each axis count.
    kernel[(np.abs(offset) > 3.5 * sigma).any(axis=-1)] = 0
    return kernel @ w / squared_density(p, periodic)


def ripley_k(p, periodic, radii):
    v = pairs(p, periodic, radii[-1])
    d, w = np.hypot(*v.T), weights(v, periodic)
    area, n = SIZE.prod(), len(p)
    return [area**2 / (n * (n - 1)) * w[d <= r].sum() for r in radii]


def periodogram(p, frequencies):
    phase = np.exp(-2j * np.pi * p @ np.array(frequencies).T)
    return np.abs(phase.sum(axis=0)) ** 2 / len(p)


def largest_empty_circle(p):
    tiled = np.concatenate([p + SIZE * [i, j] for i in range(-1, 2) for j in range(-1, 2)])
    vertices = spatial.Voronoi(tiled).vertices
    inside = vertices[((vertices >= 0) & (vertices <= SIZE)).all(axis=1)]
    return cKDTree(tiled).query(inside)[0].max()


def transport(a, b):
    cost = spatial.distance.cdist(a, b, "sqeuclidean")
    rows, columns = optimize.linear_sum_assignment(cost)
    return np.sqrt(cost[rows, columns].sum())


def chamfer(a, b):
    return cKDTree(b).query(a)[0].mean() + cKDTree(a).query(b)[0].mean()


golden = {"size": SIZE.tolist(), "a": A.tolist(), "b": B.tolist(), "sides": []}
for periodic in [False, True]:
    radii = np.linspace(0.0004, 0.2, 12)
    k_radii = np.linspace(0.02, 0.16, 8)
    places = 0.01 * np.array([[0, 0], [4, 0], [-4, 3], [7, -6], [0, 10], [-9, -1]])
    frequencies = [[1, 0], [0, 1 / 0.7], [3, 2 / 0.7], [-5, 4 / 0.7], [11, -8 / 0.7]]
    golden["sides"].append(
        {
            "periodic": periodic,
            "nearest": nearest(A, 6, periodic).ravel().tolist(),
            "sigma": 0.04,
            "pair_correlation": pair_correlation(A, periodic, 0.04, radii),
            "density_sigma": 0.02,
            "density_places": places.tolist(),
            "density": pair_density(A, periodic, 0.02, places).tolist(),
            "k": ripley_k(A, periodic, k_radii),
        }
    )
golden["frequencies"] = frequencies
golden["power"] = periodogram(A, frequencies).tolist()
golden["periodic_hole"] = float(largest_empty_circle(A))
golden["wasserstein"] = float(transport(A, B))
golden["chamfer"] = float(chamfer(A, B))
golden["relative_radius"] = float(spatial.distance.pdist(A).min() / 2 / np.sqrt(SIZE.prod() / (2 * np.sqrt(3) * len(A))))

own = np.asarray(pointpats.PointPattern(A).nnd).ravel()
assert np.allclose(own, nearest(A, 1, False).ravel()), "pointpats and scipy disagree on nearest neighbours"
# Its K is not corrected for the border and takes the bounding box for the window: the plain sums over pairs, from
# which the golden K is made by weighting, must agree with it.
support, theirs = pointpats.k(A, support=np.linspace(0.02, 0.16, 8))
lengths = np.hypot(*pairs(A, False, 0.2).T)
plain = [np.ptp(A, axis=0).prod() / len(A) ** 2 * (lengths < r).sum() for r in support]
assert np.allclose(theirs, plain), (theirs, plain)
print("pointpats agrees:", np.c_[support, theirs, plain].round(5).tolist()[-1])
theirs = RipleysKEstimator(SIZE.prod(), x_max=SIZE[0], y_max=SIZE[1], x_min=0, y_min=0)(A, k_radii, mode="translation")
assert np.allclose(theirs, golden["sides"][0]["k"]), (theirs, golden["sides"][0]["k"])
print("astropy agrees:", theirs[-1])


def rounded(value):
    if isinstance(value, float):
        return float(f"{value:.12g}")
    if isinstance(value, (list, tuple)):
        return [rounded(one) for one in value]
    if isinstance(value, dict):
        return {name: rounded(one) for name, one in value.items()}
    return value


path = pathlib.Path(__file__).with_name("golden.json")
path.write_text(json.dumps(rounded(golden), separators=(",", ":")) + "\n")
print(path, path.stat().st_size, "bytes")
