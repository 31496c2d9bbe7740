#!/usr/bin/env python3
"""An epoch of the published tension recipe in PyTorch, for bench_tension_train to compare with.

What Ugail and Howard (2026), section 5.4, algorithm 1, say of a sample: a classical step, two learned ones, Chamfer distance,
smoothness, bending, and consistency under two rotations; batches of 8, clipping, AdamW. Every function works on a group of polygons
of one space, groups x vertices x coordinates: of one polygon for the paper's sample-by-sample procedure, of a batch's polygons in the
space for the grouped one of its section 6.2. Curves are drawn at random, as no time depends on them.

    peer_tension_epoch.py [--threads N]                 seconds of an epoch with each procedure, scaled up from a tenth of it, or
                                                        from what --seconds allow
    peer_tension_epoch.py --check STEP WEIGHTS          the losses of a published step, without dropout, as JSON
"""

import argparse
import json
import math
import os
import struct
import sys
import time

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--threads", type=int, default=1)
parser.add_argument("--seconds", type=float, default=10, help="that each procedure may take")
parser.add_argument("--check", nargs=2, metavar=("STEP", "WEIGHTS"))
given = parser.parse_args()
# The BLAS below PyTorch has threads of its own, and looks here when it is loaded.
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = str(given.threads)
# Threads that wait by spinning stop each other on a machine that others use, too.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

try:
    import torch
except ImportError:
    sys.exit("PyTorch is not installed")

SPACES = ("plane", "sphere", "disk")
CURVES, CONTROL_POINTS, TRUTH_POINTS, BATCH = 960, 12, 1000, 8
WARM_UP_TENSION, LEARNED_STEPS, ROTATIONS = -0.15, 2, 2
ANGLE_LIMIT = math.pi / 4 - 0.02
SMOOTHNESS = {"plane": 0.05, "sphere": 0.15, "disk": 0.05}
BENDING, CONSISTENCY, BENDING_OFFSET = 1e-4, 0.1, 1e-7
PARALLEL_SHARE = 0.9


class Block(torch.nn.Module):
    def __init__(self, width):
        super().__init__()
        self.net = torch.nn.Sequential(
            torch.nn.Linear(width, width),
            torch.nn.LayerNorm(width),
            torch.nn.GELU(),
            torch.nn.Dropout(0.05),
            torch.nn.Linear(width, width),
            torch.nn.LayerNorm(width),
        )

    def forward(self, x):
        return torch.nn.functional.gelu(x + self.net(x))


class Predictor(torch.nn.Module):
    """Section 5.3: 140,505 weights."""

    def __init__(self, width=128):
        super().__init__()
        self.geom_embed = torch.nn.Embedding(3, 8)
        self.input_proj = torch.nn.Sequential(torch.nn.Linear(14, width), torch.nn.LayerNorm(width), torch.nn.GELU())
        self.trunk = torch.nn.Sequential(*(Block(width) for _ in range(4)))
        self.head = torch.nn.Sequential(torch.nn.Linear(width, 32), torch.nn.GELU(), torch.nn.Linear(32, 1))

    def forward(self, features, space):
        row = torch.tensor({"disk": 0, "plane": 1, "sphere": 2}[space])
        code = self.geom_embed(row).expand(*features.shape[:-1], 8)
        x = self.head(self.trunk(self.input_proj(torch.cat((features, code), -1))))
        return -ANGLE_LIMIT + 2 * ANGLE_LIMIT * torch.sigmoid(x.squeeze(-1))


# Geometry


def following(x, dim=1):
    return torch.roll(x, -1, dim)


def before(x, dim=1):
    return torch.roll(x, 1, dim)


def dot(x, y):
    return (x * y).sum(-1)


def centred(p, q):
    """q as seen from p in the disk, complex: eq. (3) with -p."""
    return (q - p) / (1 - p.conj() * q)


def measure_plane(p):
    edge = following(p) - p
    last = before(edge)
    angles = torch.atan2(last[..., 0] * edge[..., 1] - last[..., 1] * edge[..., 0], dot(last, edge))
    return angles, edge.norm(dim=-1)


def measure_sphere(p):
    """Eq. (2): tangents at p from the vertex before and to the next."""
    nxt, last = following(p), before(p)
    out = nxt - dot(p, nxt).unsqueeze(-1) * p
    back = dot(p, last).unsqueeze(-1) * p - last
    angles = torch.atan2(dot(torch.cross(back, out, dim=-1), p), dot(back, out))
    return angles, torch.atan2(torch.cross(p, nxt, dim=-1).norm(dim=-1), dot(p, nxt))


def measure_disk(p):
    z = torch.view_as_complex(p)
    out = centred(z, following(z))
    turn = -out * centred(z, before(z)).conj()
    return torch.atan2(turn.imag, turn.real), 2 * torch.atanh(out.abs())


def insert_plane(p, angles):
    edge = following(p) - p
    left = torch.stack((-edge[..., 1], edge[..., 0]), -1)
    return p + 0.5 * (edge + torch.tan(angles).unsqueeze(-1) * left)


def insert_sphere(p, angles):
    q = following(p)
    apex = p + q + torch.tan(angles).unsqueeze(-1) * torch.cross(p, q, dim=-1)
    return apex / apex.norm(dim=-1, keepdim=True)


def insert_disk(p, angles):
    """Eq. (8) with the radius of the isosceles triangle: tanh(new) = tanh(edge / 2) / cos(angle)."""
    z = torch.view_as_complex(p)
    out = centred(z, following(z))
    square = out.real**2 + out.imag**2
    limit = PARALLEL_SHARE * torch.sqrt((1 - square) / square)
    slope = torch.maximum(torch.minimum(torch.tan(angles), limit), -limit)
    # With the slope s = tan(angle) the direction is (1 + i s) / sqrt(1 + s^2) and 1 / cos(angle) = sqrt(1 + s^2).
    scale = 1 / (1 + torch.sqrt(1 - square * (1 + slope**2)))
    apex = scale * torch.complex(torch.ones_like(slope), slope) * out
    return torch.view_as_real((z + apex) / (1 + z.conj() * apex))


MEASURE = {"plane": measure_plane, "sphere": measure_sphere, "disk": measure_disk}
INSERT = {"plane": insert_plane, "sphere": insert_sphere, "disk": insert_disk}


def refined(p, angles, space):
    return torch.stack((p, INSERT[space](p, angles)), 2).flatten(1, 2)


def features_of(p, space):
    """Eq. (17) without the curvature."""
    angles, lengths = MEASURE[space](p)
    relative = lengths / lengths.mean(-1, keepdim=True)
    turns = angles / math.pi
    stencil = (before(turns), turns, following(turns), torch.roll(turns, -2, 1))
    return torch.stack((*stencil, relative, following(relative)), -1)


def warm_up(p, space):
    """Eq. (9) with its printed sign."""
    angles, _ = MEASURE[space](p)
    inner, outer = angles + following(angles), before(angles) + torch.roll(angles, -2, 1)
    tension = (WARM_UP_TENSION * outer + (1 - WARM_UP_TENSION) * inner) / 8
    return refined(p, tension.clamp(-ANGLE_LIMIT, ANGLE_LIMIT), space)


def rotated(p, space):
    """Each polygon turned by a rotation of its own."""
    count = p.shape[0]
    if space == "sphere":
        q, r = torch.linalg.qr(torch.randn(count, 3, 3, dtype=p.dtype))
        q = q * torch.sign(torch.diagonal(r, dim1=1, dim2=2)).unsqueeze(1)
        q[:, :, 0] = q[:, :, 0] * torch.det(q).unsqueeze(-1)
        return p @ q
    turn = 2 * math.pi * torch.rand(count, dtype=p.dtype)
    c, s = torch.cos(turn), torch.sin(turn)
    return p @ torch.stack((torch.stack((c, s), -1), torch.stack((-s, c), -1)), 1)


def losses(network, control, truth, space):
    """The terms of eq. (18), each a mean over the group's polygons."""
    with torch.no_grad():
        p = warm_up(control, space)
    for _ in range(LEARNED_STEPS):
        p = refined(p, network(features_of(p, space), space), space)
    distances = torch.cdist(p, truth)
    chamfer = 0.5 * (distances.min(2).values.mean() + distances.min(1).values.mean())
    angles, lengths = MEASURE[space](p)
    bending = (angles / (0.5 * (lengths + before(lengths)) + BENDING_OFFSET)) ** 2
    still = p.detach()
    with torch.no_grad():
        images = [features_of(x, space) for x in (still, *(rotated(still, space) for _ in range(ROTATIONS)))]
    kept, *moved = network(torch.cat(images, 0), space).chunk(1 + ROTATIONS)
    consistency = sum(((kept - other) ** 2).sum(-1).mean() for other in moved) / ROTATIONS
    return chamfer, (angles**2).mean(), bending.mean(), consistency


def total_loss(network, control, truth, space):
    chamfer, smoothness, bending, consistency = losses(network, control, truth, space)
    return chamfer + SMOOTHNESS[space] * smoothness + BENDING * bending + CONSISTENCY * consistency


# An epoch


def draw_curve(space):
    """A wavy circle."""
    t = 2 * math.pi * torch.arange(TRUTH_POINTS) / TRUTH_POINTS
    radius = 1 + 0.2 * torch.rand(1) * torch.cos(3 * t + 6 * torch.rand(1))
    flat = torch.stack((radius * torch.cos(t), radius * torch.sin(t)), -1)
    if space == "sphere":
        return torch.nn.functional.normalize(torch.cat((flat, torch.ones(TRUTH_POINTS, 1)), -1), dim=-1)
    return flat if space == "plane" else 0.5 * flat


def draw_samples(count):
    samples = []
    for i in range(count):
        truth = draw_curve(SPACES[i % 3])
        places = torch.arange(CONTROL_POINTS) * TRUTH_POINTS // CONTROL_POINTS
        samples.append((SPACES[i % 3], truth[places], truth))
    return [samples[i] for i in torch.randperm(count)]


def groups_of(batch, grouped):
    """Lists of samples that go through the network together."""
    if not grouped:
        return [[sample] for sample in batch]
    return [g for g in ([s for s in batch if s[0] == space] for space in SPACES) if g]


def train_batch(network, optimizer, batch, grouped):
    optimizer.zero_grad()
    for group in groups_of(batch, grouped):
        control = torch.stack([control for _, control, _ in group])
        truth = torch.stack([truth for _, _, truth in group])
        loss = total_loss(network, control, truth, group[0][0])
        (loss * len(group) / len(batch)).backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), 0.5)
    optimizer.step()


def time_epoch(grouped, max_seconds):
    torch.manual_seed(1)
    network = Predictor()
    optimizer = torch.optim.AdamW(network.parameters(), lr=1e-3, betas=(0.9, 0.95), weight_decay=1e-4, foreach=True)
    samples = draw_samples(CURVES // 10)
    batches = [samples[first : first + BATCH] for first in range(0, len(samples), BATCH)]
    train_batch(network, optimizer, batches[0], grouped)
    done, start = 0, time.perf_counter()
    for batch in batches:
        train_batch(network, optimizer, batch, grouped)
        done += len(batch)
        seconds = time.perf_counter() - start
        if seconds > max_seconds:
            break
    return seconds * CURVES / done


# A published step


def read_safetensors(path):
    with open(path, "rb") as file:
        header = json.loads(file.read(struct.unpack("<Q", file.read(8))[0]))
        data = file.read()
    header.pop("__metadata__", None)
    arrays = {}
    for name, entry in header.items():
        begin, end = entry["data_offsets"]
        kind = {"F64": torch.float64, "F32": torch.float32, "I64": torch.int64}[entry["dtype"]]
        arrays[name] = torch.frombuffer(bytearray(data[begin:end]), dtype=kind).reshape(entry["shape"])
    return arrays


def check(step_path, weights_path):
    step, weights = read_safetensors(step_path), read_safetensors(weights_path)
    network = Predictor().double().eval()
    network.load_state_dict({name: weights.get("weight." + name, weights.get(name)) for name in network.state_dict()})
    rows = []
    for name, space in (("euclidean", "plane"), ("spherical", "sphere"), ("hyperbolic", "disk")):
        control, truth = step[name + ".control"].unsqueeze(0), step[name + ".truth"].unsqueeze(0)
        terms = losses(network, control, truth, space)
        loss = total_loss(network, control, truth, space)
        values = dict(zip(("chamfer", "smoothness", "bending", "consistency"), (float(term) for term in terms)))
        rows.append({"geometry": name, **values, "loss": float(loss)})
    print(json.dumps(rows, indent=1))


torch.set_num_threads(given.threads)
if given.check:
    check(*given.check)
else:
    print(f"version {torch.__version__}")
    print(f"samples {time_epoch(False, given.seconds):.6g}")
    print(f"groups {time_epoch(True, given.seconds):.6g}")
