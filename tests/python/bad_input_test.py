# SPDX-License-Identifier: Apache-2.0
"""Python: what cannot be used is one ValueError that names it, and nothing crashes."""

import pathlib
import random
import tempfile
import unittest
import warnings

import controlspace
import numpy as np

BOX = [(0, 0, 0), (1, 1, 1)]
P = np.full((3, 3), 0.5)
H = np.full(3, 0.1)
NAN, INF = float("nan"), float("inf")
UNIT = np.eye(3)


def changed(array, index, value):
    array = np.array(array, float)
    array[index] = value
    return array


def tensors(*last):
    return np.array([UNIT, UNIT, *last])


class BadInput(unittest.TestCase):
    def refused(self, what, action, *arguments, **options):
        with self.subTest(what, arguments=arguments, options=options):
            with self.assertRaises(ValueError) as caught:
                action(*arguments, **options)
            self.assertIn(what, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))

    def test_sources(self):
        build = controlspace.build
        self.refused("points is empty", build, np.zeros((0, 3)), [])
        self.refused("shape (0,)", build, [], [])
        self.refused("shape (3,)", build, (0, 0, 0), [1])
        self.refused("shape (3, 2)", build, P[:, :2], H)
        self.refused("points is no array", build, [(0, 0, 0), (1, 1)], H)
        self.refused("dtype <U1", build, [("a", "b", "c")], [1])
        self.refused("dtype complex", build, P * 1j, H)
        self.refused("dtype object", build, None, H)
        for value in (NAN, INF, -INF):
            self.refused("points[1] is", build, changed(P, (1, 2), value), H)
            self.refused("h[2] is", build, P, changed(H, 2, value))
        self.refused("points[1] is", build, changed(P, (1, 0), 2), H, box=BOX)
        self.refused("h[1] is 0.0", build, P, changed(H, 1, 0))
        self.refused("h[1] is -1.0", build, P, changed(H, 1, -1))
        self.refused("source 1", build, P, changed(H, 1, 1e-320), box=BOX)
        self.refused("shape (2,)", build, P, H[:2])
        self.refused("shape (3, 5)", build, P, np.ones((3, 5)))
        self.refused("shape ()", build, P, 0.1)

    def test_masked_arrays(self):
        build = controlspace.build
        hidden = np.ma.masked_greater(P, 1)
        controlspace.build(hidden, H)  # nothing is
        hidden[1, 2] = np.ma.masked
        self.refused("points has masked entries", build, hidden, H)
        self.refused("h has masked entries", build, P, np.ma.masked_equal([1, 2, 3], 2))
        self.refused("growth has masked entries", build, P, H, growth=np.ma.masked_less(H, 1))
        self.refused("box has masked entries", build, P, H, box=np.ma.masked_equal(BOX, 1))
        field = controlspace.build(P, H, box=BOX)
        for action in (field.size, field.metric, field.riemannian):
            self.refused("x has masked entries", action, hidden)
        self.refused("a has masked entries", field.edge_length, hidden, P)

    def test_tensors(self):
        build = controlspace.build
        self.refused("h[2] is", build, P, tensors(np.diag((1, 1, -1))))
        self.refused("h[2] is", build, P, tensors(np.diag((1, 1, 0))))
        self.refused("h[2] is", build, P, tensors(np.diag((1, 1, NAN))))
        self.refused("h[2] is", build, P, tensors(UNIT + np.eye(3, k=1)))
        self.refused("h[0] is", build, P, np.ones((3, 6)))
        self.refused("h[1] is", build, P, changed(np.eye(6)[:3] + [1, 1, 1, 0, 0, 0], (1, 5), INF))

    def test_options(self):
        build = controlspace.build
        for box in (BOX[::-1], [BOX[0], BOX[0]], [BOX[0], (1, 1, INF)], [BOX[0], (NAN, 1, 1)]):
            self.refused("", build, P, H, box=box)
        self.refused("box has the shape (3,)", build, P, H, box=(1, 2, 3))
        self.refused("no structure 'K_x'", build, P, H, "K_x")
        self.refused("structure is 7", build, P, H, 7)
        for growth in (0.9, NAN, INF, -INF):
            self.refused("growth is", build, P, H, growth=growth)
        self.refused("growth has the dtype", build, P, H, growth="a lot")
        self.refused("growth has the shape (2,)", build, P, H, growth=(1.1, 1.2))
        self.refused("growth[1] is nan", build, P, H, growth=changed(np.full(len(P), 1.1), 1, NAN))
        for delta in (0, -1, NAN, INF):
            self.refused("delta is", build, P, H, delta=delta)
        self.refused("h_min is 0.0", build, P, H, h_min=0)
        self.refused("h_max is nan", build, P, H, h_max=NAN)
        self.refused("h_min <= h_max", build, P, H, h_min=2, h_max=1)
        self.refused("no option 'colour'", build, P, H, colour=1)
        self.refused("option tau is 'much'", build, P, H, tau="much")

    def test_places(self):
        field = controlspace.build(P, H, box=BOX)
        for ask in (field.metric, field.size, field.riemannian, lambda x: field.edge_length(x, x)):
            self.refused("position 2 is NaN", ask, changed(P, (2, 1), NAN))
            self.refused("shape (3, 2)", ask, P[:, :2])
            self.refused("shape (3,)", ask, P[0])
            self.refused("dtype", ask, [("a", "b", "c")])
            self.refused("dtype", ask, None)
            self.assertEqual(len(ask(np.zeros((0, 3)))), 0)
            self.assertTrue(np.isfinite(ask(changed(P, (1, 1), 1e300))).all())
        large = np.zeros((200000, 3))
        self.refused("position 123456 is NaN", field.size, changed(large, (123456, 0), NAN))
        self.refused("is NaN", field.size, 0, NAN, 0)
        self.refused("three numbers", field.size, 0, 0)
        self.refused("three numbers", field.size, "a", 0, 0)
        self.refused("order is 'xyz'", field.riemannian, P, "xyz")
        self.refused("one end for each", field.edge_length, P, P[:2])

    def test_files(self):
        field = controlspace.build(P, H, box=BOX)
        with tempfile.TemporaryDirectory() as folder:
            nowhere = pathlib.Path(folder, "no", "field.ctrl")
            text = pathlib.Path(folder, "text.ctrl")
            text.write_text("no control space")
            self.refused("", field.save, nowhere)
            self.refused("", controlspace.load, nowhere)
            self.refused("", controlspace.load, text)
            self.refused("", field.export, pathlib.Path(folder, "field.doc"))
            self.refused("", field.export, pathlib.Path(folder, "field.vtu"), colour=1)
        for file in (3, None, "", "a\0b"):
            self.refused("file is", field.save, file)
            self.refused("file is", controlspace.load, file)

    def test_comparison(self):
        self.refused("h[1]", controlspace.compare, P, changed(H, 1, -1))
        self.refused("K_x", controlspace.compare, P, H, ["K_x"])
        self.refused("--colour", controlspace.compare, P, H, colour=1)
        self.refused("points[0]", controlspace.compare, P, H, box=[(0, 0, 0), (0.1, 1, 1)])


class Fuzz(unittest.TestCase):
    """Random arguments, good and bad: an answer, or a ValueError."""

    CALLS = 100000
    NUMBERS = (0, -0.0, 1, -1, 0.5, 1e-300, 1e300, 5e-324, NAN, INF, -INF)
    OBJECTS = (None, "abc", b"", {}, (), 3, [[]], [("x",)], object())
    DTYPES = ("f2", "f4", "i1", "u8", ">f8", "c16", "S3", "?")

    def array(self):
        kind, n = self.random.randrange(8), self.random.randrange(4)
        if kind == 0:
            return self.random.choice(self.OBJECTS)
        x = np.linspace(0.1, 1, 36)[: 9 * n].copy()
        shape = self.random.choice([(n,), (n, 3), (n, 6), (n, 3, 3), (n, 2), ()])
        x = np.resize(x if n else np.ones(1), shape)
        if kind < 3 and x.size:
            x.flat[self.random.randrange(x.size)] = self.random.choice(self.NUMBERS)
        if kind == 3:
            return x.astype(self.random.choice(self.DTYPES))
        return x.T if kind == 4 else x

    def places(self):
        if self.random.random() < 0.3:
            return self.array()
        return [[self.random.uniform(-1, 2) for _ in range(3)] for _ in range(3)]

    def lengths(self):
        return self.array() if self.random.random() < 0.5 else [0.2, 0.5, 1]

    def one_call(self, field):
        kind = self.random.randrange(100)
        if kind == 0:
            box = self.array() if self.random.random() < 0.3 else [(-1, -1, -1), (2, 2, 2)]
            growth = self.random.choice(self.NUMBERS) if self.random.random() < 0.2 else 1.5
            name = self.random.choice(self.names)
            return controlspace.build(self.places(), self.lengths(), name, box, growth)
        if kind < 20:
            return field.size(*self.random.choices(self.NUMBERS, k=3))
        ask = (field.size, field.metric, field.riemannian)[kind % 3]
        return ask(self.places()) if kind < 80 else field.edge_length(self.places(), self.places())

    def test_any_arguments(self):
        self.random = random.Random(7)
        self.names = [*controlspace.structures(), "K_x", ""]
        field, refused = controlspace.build(P, H, box=BOX), 0
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            for _ in range(self.CALLS):
                try:
                    answer = self.one_call(field)
                except ValueError:
                    refused += 1
                    continue
                if isinstance(answer, controlspace.Field):
                    field = answer
        self.assertGreater(refused, self.CALLS // 20)
        self.assertLess(refused, self.CALLS // 2)


if __name__ == "__main__":
    unittest.main()
