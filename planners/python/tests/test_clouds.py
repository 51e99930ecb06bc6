# SPDX-License-Identifier: BSD-3-Clause
"""Live clouds from NumPy arrays: any layout gives the same voxels, worlds see them, faults are errors that change nothing."""
import threading

import numpy
import pytest

import leeway

BOX = [[-2, -2, -1], [2, 2, 2]]


def wall(width=160, height=120, depth=1.5):
    return numpy.full((height, width), depth, dtype=numpy.float32), (130.0, 130.0, (width - 1) / 2, (height - 1) / 2)


def looking_along_x(at):
    pose = numpy.eye(4)
    pose[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    pose[:3, 3] = at
    return pose


def test_points_of_every_layout_are_the_same_voxels():
    points = numpy.random.default_rng(1).uniform(-0.9, 0.9, (60, 3)).astype(numpy.float32)
    wide = numpy.zeros((60, 7), dtype=numpy.float32)
    wide[:, 2:5] = points
    structured = wide[:, 2:5]
    expected = None
    for given in (points, points.astype(numpy.float64), points.reshape(6, 10, 3), structured, wide.reshape(6, 10, 7)[:, :, 2:5]):
        cloud = leeway.Cloud(resolution=0.02, box=BOX)
        assert cloud.insert_points(given, 1.0, clears=False)["inserted"] == 60
        voxels = sorted(map(tuple, cloud.voxels()))
        expected = expected or voxels
        assert voxels == expected
    cloud = leeway.Cloud(resolution=0.02, box=BOX)
    fields = {"intensity": (0, 7), "x": (8, 7), "y": (12, 7), "z": (16, 7)}
    counts = cloud.insert_message(wide.tobytes(), fields, 60, 28, 1.0, clears=False)
    assert counts["inserted"] == 60 and sorted(map(tuple, cloud.voxels())) == expected
    big = leeway.Cloud(resolution=0.02, box=BOX)
    big.insert_message(wide.astype(">f4").tobytes(), fields, 20, 28, 1.0, height=3, row_step=560, is_bigendian=True, clears=False)
    assert sorted(map(tuple, big.voxels())) == expected


def test_depth_images_clear_what_they_looked_through():
    depth, lens = wall()
    for image in (depth, (1000 * depth).astype(numpy.uint16), numpy.pad(depth, 8)[8:-8, 8:-8]):
        cloud = leeway.Cloud(resolution=0.02, box=BOX, unseen="blocked")
        cloud.insert_points(numpy.array([[0.51, 0.01, 0.01]]), 1.0, in_world=True, clears=False, sensor=1)
        assert cloud.states([[0.51, 0.01, 0.01]]).tolist() == [2]
        counts = cloud.insert_depth(image, lens, 2.0, pose=looking_along_x([-0.5, 0, 0]))
        assert counts["cleared"] == 1 and counts["uncovered"] > 1000 and counts["inserted"] == depth.size
        assert cloud.states([[0.51, 0.01, 0.01], [1.01, 0.01, 0.01], [1.8, 0, 0]]).tolist() == [1, 2, 0]
        matrix = [[lens[0], 0, lens[2]], [0, lens[1], lens[3]], [0, 0, 1]]
        assert cloud.insert_depth(image, matrix, 3.0, pose=looking_along_x([-0.5, 0, 0]))["cleared"] == 0


def test_worlds_see_clouds_and_keep_snapshots(robot, scene):
    world = leeway.World(robot, scene, group="arm")
    checker = world.checker
    q = numpy.zeros(checker.dof)
    cloud = leeway.Cloud(resolution=0.02, box=BOX)
    empty = world.see("cloud", cloud)
    assert empty.objects == checker.objects + ["cloud"]
    before = empty.clearance(q[None])
    lower = float(before.lower[0])
    near = numpy.random.default_rng(2).uniform(-0.3, 0.3, (2000, 3))
    cloud.insert_points(near, 1.0, in_world=True, clears=False)
    seen = world.see("cloud", cloud)
    assert seen.clearance(q[None]).lower[0] < lower
    assert empty.clearance(q[None]).lower[0] == lower
    assert cloud.info["shapes"] > 0 and cloud.info["excess"] == pytest.approx(3**0.5 * 0.02)
    # the robot's own body: no point within the shadow of it stays
    own = leeway.Cloud(resolution=0.02, box=BOX, shadow=0.05)
    counts = own.insert_points(near, 1.0, in_world=True, clears=False, robot=checker, state=q)
    assert counts["own"] > 0 and counts["own"] + counts["inserted"] == 2000
    world.remove("cloud")
    assert world.checker.objects == checker.objects


def test_faults_are_errors_that_change_nothing():
    cloud = leeway.Cloud(resolution=0.05, box=BOX, jump_distance=0.1)
    point = numpy.array([[0.5, 0.0, 0.0]])
    cloud.insert_points(point, 5.0)
    for stamp in (5.0, 4.0):
        with pytest.raises(leeway.CoreError, match="late"):
            cloud.insert_points(point + 0.3, stamp)
    with pytest.raises(leeway.CoreError, match="jumped"):
        cloud.insert_points(point, 6.0, pose=[1, 0, 0])
    cloud.allow_jump()
    cloud.insert_points(numpy.zeros((0, 3)), 6.0, pose=[1, 0, 0])
    counts = cloud.insert_points(numpy.array([[numpy.nan, 0, 0], [0.1, 0.1, 0.1]]), 7.0, pose=[1, 0, 0])
    assert counts["not_measured"] == 1 and counts["inserted"] == 1
    depth, lens = wall()
    for wrong in (lambda: cloud.insert_points(point.astype(numpy.int32), 8.0), lambda: cloud.insert_points(point[0], 8.0),
            lambda: cloud.insert_depth(depth.astype(numpy.float64), lens, 8.0), lambda: cloud.insert_depth(depth[:, ::2], lens, 8.0),
            lambda: cloud.insert_depth(depth, lens[:3], 8.0), lambda: cloud.insert_points(point[::-1].repeat(2, 0)[::-1], 8.0),
            lambda: cloud.insert_message(b"abc", {"x": (0, 7)}, 1, 4, 8.0), lambda: cloud.set_box([0, 0, 0], [1, 1, 1], "gone"),
            lambda: cloud.insert_points(numpy.asfortranarray(numpy.ones((5, 3))), 8.0), lambda: leeway.Cloud(unseen="maybe"), lambda: leeway.Cloud(resolution=-1), lambda: cloud.voxels("unseen")):
        with pytest.raises(ValueError):
            wrong()
    assert cloud.info["frames"] == 3 and cloud.info["late"] == 2 and cloud.info["jumped"] == 1


def test_full_clouds_make_no_scene(robot, scene):
    world = leeway.World(robot, scene, group="arm")
    cloud = leeway.Cloud(resolution=0.05, box=BOX, most_blocks=1)
    with pytest.raises(MemoryError, match="lost"):
        cloud.insert_points(numpy.array([[1.0, 0, 0], [-1.0, 0, 0]]), 1.0)
    assert not cloud.info["complete"]
    with pytest.raises(leeway.Error, match="incomplete"):
        world.see("cloud", cloud)
    cloud.clear()
    world.see("cloud", cloud)


def test_ages_boxes_and_octomaps(tmp_path):
    cloud = leeway.Cloud(resolution=0.05, box=BOX, unseen="blocked")
    cloud.insert_points(numpy.array([[0.51, 0.01, 0.01]]), 1.0, clears=False)
    cloud.insert_points(numpy.array([[0.81, 0.01, 0.01]]), 2.0, clears=False)
    assert cloud.forget_before(1.5) == 1 and len(cloud.voxels()) == 1
    cloud.set_box([0, 0, 0], [0.5, 0.5, 0.5], "free")
    for name in ("map.bt", "map.ot"):
        cloud.write_octomap(tmp_path / name)
        copy = leeway.Cloud(resolution=0.05, box=BOX, unseen="blocked")
        copy.read_octomap(tmp_path / name)
        assert (copy.voxels() == cloud.voxels()).all() and (copy.voxels("free") == cloud.voxels("free")).all()
    with pytest.raises(leeway.InputError):
        cloud.read_octomap(tmp_path / "none.bt")


def test_threads_take_turns():
    cloud = leeway.Cloud(resolution=0.02, box=BOX)
    points = numpy.random.default_rng(3).uniform(-0.9, 0.9, (5000, 3)).astype(numpy.float32)

    def work(sensor):
        for stamp in range(1, 20):
            cloud.insert_points(points, float(stamp), sensor=sensor, clears=False)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert cloud.info["frames"] == 4 * 19


def test_threads_of_a_cloud_give_another_map():
    depth, intrinsics = wall()
    maps = []
    for threads in (1, 2, 0):
        cloud = leeway.Cloud(resolution=0.02, box=BOX, unseen="blocked", threads=threads)
        counts = [cloud.insert_depth(depth + 0.01 * k, intrinsics, 1.0 + k, pose=looking_along_x([-1, 0, 0.1 * k])) for k in range(4)]
        maps.append((counts, sorted(map(tuple, cloud.voxels())), len(cloud.voxels("free"))))
    assert maps[0] == maps[1] == maps[2] and maps[0][2] > 10000
    with pytest.raises(ValueError, match="threads"):
        leeway.Cloud(threads=-1)
