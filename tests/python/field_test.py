# SPDX-License-Identifier: Apache-2.0
"""Python: fields answer as they were asked for, and the examples of the README run."""

import copy
import doctest
import os
import pathlib
import pickle
import signal
import tempfile
import threading
import time
import unittest
import warnings

import controlspace
import numpy as np

README = pathlib.Path(__file__).parents[2] / "src/python/README.md"
BOX = [(-1, -1, -1), (1, 1, 1)]
random = np.random.default_rng(1)


def sources(n=50):
    return random.uniform(-0.9, 0.9, (n, 3)), random.uniform(0.02, 0.2, n)


def tensors(n=50):
    points, _ = sources(n)
    turned, _ = np.linalg.qr(random.normal(size=(n, 3, 3)))
    lengths = random.uniform(0.05, 0.3, (n, 1, 3))
    m = (turned * lengths) @ turned.transpose(0, 2, 1)
    return points, (m + m.transpose(0, 2, 1)) / 2


def exact_sizes(points, h, growth, x):
    """The field of isotropic cones, below half of the diagonal."""
    distances = np.linalg.norm(x[:, None] - points, axis=2)
    return np.minimum((h + (np.asarray(growth) - 1) * distances).min(axis=1), np.sqrt(3))


class Fields(unittest.TestCase):
    def test_a_box_without_thickness_is_a_plane(self):
        points, h = sources()
        points[:, 1] = 0.5
        box = [(-1, 0.5, -1), (1, 0.5, 1)]
        field = controlspace.build(points, h, box=box)
        np.testing.assert_array_equal(field.box, box)
        x = random.uniform(-1, 1, (500, 3)) * (1, 0, 1) + (0, 0.5, 0)
        exact = np.minimum(exact_sizes(points, h, 1.25, x), np.sqrt(2))
        k = field.size(x) / exact
        self.assertLessEqual(np.max(np.sqrt(3) * (k + 1 / k - 2)), 0.1)
        with self.assertRaisesRegex(ValueError, r"points\[7\]"):
            controlspace.build(points + (np.arange(50) == 7)[:, None] * 1e-6, h, box=box)
        with self.assertRaisesRegex(ValueError, "two axes"):
            controlspace.build(points[:1], h[:1], box=[points[0], points[0] + (0.1, 0, 0)])

    def test_lengths_follow_the_cones(self):
        points, h = sources()
        x = random.uniform(-1, 1, (1000, 3))
        for growth in (1.1, 1.25, 2, random.uniform(1, 1.5, len(points))):
            field = controlspace.build(points, h, box=BOX, growth=growth)
            self.assertLessEqual(field.delta, 0.1)
            k = field.size(x) / exact_sizes(points, h, growth, x)
            self.assertLessEqual(np.max(np.sqrt(3) * (k + 1 / k - 2)), 0.1)

    def test_every_structure(self):
        points, h = sources()
        x = random.uniform(-1, 1, (100, 3))
        for name in controlspace.structures():
            with self.subTest(name):
                field = controlspace.build(points, h, name, BOX)
                self.assertIsNone(field.delta)
                k = field.size(x) / exact_sizes(points, h, 1.25, x)
                # Inserted and graded: K_L 1.11, the others less.
                self.assertLess(np.median(np.maximum(k, 1 / k)), 1.125)

    def test_sizes_are_the_smallest_lengths(self):
        points, m = tensors()
        field = controlspace.build(points, m, "K_oV", BOX)
        x = random.uniform(-1, 1, (200, 3))
        answers = field.metric(x)
        smallest = np.linalg.eigvalsh(controlspace._arrays.matrices(answers))[:, 0]
        np.testing.assert_allclose(field.size(x), smallest, rtol=1e-9)
        np.testing.assert_array_equal(field.size(x), [field.size(*place) for place in x])

    def test_shapes_of_metrics_agree(self):
        points, m = tensors(20)
        flat = m.reshape(-1, 9)[:, [0, 4, 8, 1, 2, 5]]
        x = random.uniform(-1, 1, (50, 3))
        fields = [controlspace.build(points, h, "K_oL", BOX) for h in (m, flat)]
        np.testing.assert_array_equal(*[field.metric(x) for field in fields])

    def test_riemannian_orders(self):
        points, m = tensors()
        field = controlspace.build(points, m, "K_oL", BOX)
        x = random.uniform(-1, 1, (50, 3))
        matrices = controlspace._arrays.matrices(field.metric(x))
        expected = np.linalg.inv(matrices @ matrices)
        i, j = np.triu_indices(3)
        np.testing.assert_allclose(field.riemannian(x), expected[:, i, j], rtol=1e-9)
        lower = np.tril_indices(3)
        np.testing.assert_allclose(field.riemannian(x, "medit"), expected[:, lower[0], lower[1]])
        np.testing.assert_allclose(field.riemannian(x, "gmsh"), expected.reshape(-1, 9))

    def test_edge_lengths(self):
        field = controlspace.build([(0, 0, 0)], [0.1], "K_oV", BOX, growth=1, delta=0.1)
        a, b = random.uniform(-1, 1, (2, 1000, 3))
        expected = np.linalg.norm(b - a, axis=1) / 0.1
        np.testing.assert_allclose(field.edge_length(a, b), expected, rtol=1e-9)

    def test_large_batches_are_the_same_as_small_ones(self):
        points, m = tensors()
        field = controlspace.build(points, m, "K_oV", BOX)
        x, y = random.uniform(-1, 1, (2, 120000, 3))
        for ask in (
            field.metric,
            field.size,
            field.riemannian,
            lambda x: field.edge_length(x, y[: len(x)]),
        ):
            np.testing.assert_array_equal(ask(x)[:5000], ask(x[:5000]))

    def test_limits_of_lengths(self):
        points, m = tensors()
        x = np.vstack([points, random.uniform(-1, 1, (1000, 3))])
        for h in (m, np.linalg.eigvalsh(m)[:, 0]):
            field = controlspace.build(points, h, "K_oV", BOX, delta=0.05, h_min=0.1, h_max=0.15)
            # The limits hold at vertices, and what lies between is a mean of these.
            self.assertGreater(field.size(x).min(), 0.1 * (1 - 1e-9))
            self.assertLess(field.size(x).max(), 0.15 * (1 + 1e-9))

    def test_kinds_of_arrays(self):
        points, h = sources()
        field = controlspace.build(points.tolist(), h.astype("f4"), "K_oL", BOX)
        x = random.uniform(-1, 1, (100, 3))
        np.testing.assert_array_equal(field.size(np.asfortranarray(x)), field.size(x))
        np.testing.assert_array_equal(field.size(x[::2]), field.size(x)[::2])
        np.testing.assert_array_equal(field.size(x.astype(">f8")), field.size(x))
        self.assertEqual(field.size([(0, 0, 1)])[0], field.size(0, 0, 1))

    def test_boxes(self):
        points, h = sources()
        np.testing.assert_array_equal(controlspace.build(points, h, "K_L", BOX).box, BOX)
        low, high = controlspace.build([(1, 2, 3)], [0.1]).box
        self.assertTrue((low < (1, 2, 3)).all() and (high > (1, 2, 3)).all())

    def test_files(self):
        points, m = tensors()
        x = random.uniform(-1, 1, (100, 3))
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "field.ctrl")
            for name in ("K_oV", "K_LA"):
                field = controlspace.build(points, m, name, BOX)
                field.save(file)
                np.testing.assert_array_equal(controlspace.load(file).metric(x), field.metric(x))
            vdb = pathlib.Path(folder, "field.vdb")
            for name in {"openvdb-tiles", "openvdb-bricks"}.intersection(controlspace.structures()):
                field = controlspace.build(*sources(), name, BOX)
                field.save(vdb)
                np.testing.assert_allclose(controlspace.load(vdb).size(x), field.size(x), rtol=1e-6)
            table = pathlib.Path(folder, "-field.vti")
            field.export(table, slice=("z", 0.5), samples=16)
            self.assertGreater(table.stat().st_size, 1000)

    def test_missed_accuracy_is_a_warning(self):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            field = controlspace.build([(0, 0, 0)], [0.01], "K_oL", BOX, delta=0.1, octree_depth=2)
        self.assertGreater(field.delta, 0.1)
        self.assertIn("0.1 requested", str(said[0].message))

    def test_fields_are_not_copied(self):
        field = controlspace.build([(0, 0, 0)], [0.1])
        for attempt in (copy.copy, copy.deepcopy, pickle.dumps, lambda _: controlspace.Field()):
            self.assertRaises(TypeError, attempt, field)

    def test_ctrl_c_ends_a_build(self):
        points, h = sources(300000)
        for name in ("K_oV", "K_L"):
            for options in ({"delta": 1e-5}, {"tau": 0.01, "max_memory": 8}):
                with self.subTest(name, **options):
                    pressed = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
                    before = time.monotonic()
                    pressed.start()
                    with self.assertRaises(KeyboardInterrupt):
                        controlspace.build(points, 1e-3 * h, name, BOX, **options)
                    pressed.join()
                    self.assertLess(time.monotonic() - before, 20)
        # What comes after is built as if nothing had happened, in other threads, too.
        built = []
        thread = threading.Thread(target=lambda: built.append(controlspace.build(points[:9], h[:9])))
        thread.start()
        thread.join()
        x = random.uniform(-0.5, 0.5, (100, 3))
        np.testing.assert_array_equal(
            built[0].size(x), controlspace.build(points[:9], h[:9]).size(x)
        )

    def test_threads_read_at_the_same_time(self):
        points, h = sources()
        field = controlspace.build(points, h, "K_oV", BOX)
        x = random.uniform(-1, 1, (200000, 3))
        expected, answers = field.size(x), []
        threads = [threading.Thread(target=lambda: answers.append(field.size(x))) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for answer in answers:
            np.testing.assert_array_equal(answer, expected)

    def test_comparison(self):
        points, m = tensors(5)
        rows = controlspace.compare(
            points,
            m,
            ["K_oL", "uniform-nearest"],
            BOX,
            growth=1.5,
            epsilon=[0.1, 0.2],
            probe_grid=5,
            fine_probe_grid=5,
            access_points=100,
            access_repeats=1,
            creation_repeats=1,
        )
        self.assertEqual({row["structure"] for row in rows}, {"K_oL", "uniform-nearest"})
        self.assertEqual({row["epsilon"] for row in rows if row["structure"] == "K_oL"}, {0.1, 0.2})
        self.assertEqual({row["g_r"] for row in rows}, {1.5})
        self.assertGreater(rows[0]["bytes_total"], 0)


def load_tests(loader, tests, _):
    tests.addTests(
        doctest.DocFileSuite(
            str(README), module_relative=False, optionflags=doctest.IGNORE_EXCEPTION_DETAIL
        )
    )
    return tests


if __name__ == "__main__":
    unittest.main()
