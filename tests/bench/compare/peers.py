"""The paper's method from libraries: a sparse solver, something that finds the triangle at a point, and numpy."""

from __future__ import annotations

import ctypes
import time

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

from compare.patch import Patch, Slid


class Net:
    """The equations of an embedding: values of a fixed pattern, linear in the force densities."""

    def __init__(self, patch: Patch):
        self.edges = np.unique(np.sort(patch.sides(), axis=1), axis=0)
        self.free = np.flatnonzero(np.isnan(patch.border[:, 0]))
        self._border = patch.border
        number = np.full(len(patch.rest), -1)
        number[self.free] = np.arange(len(self.free))
        a, b = number[self.edges].T
        self._assemble(a, b, len(self.free))

    def _assemble(self, a: np.ndarray, b: np.ndarray, size: int) -> None:
        edge = np.arange(len(self.edges))
        within, first, second = (a >= 0) & (b >= 0), a >= 0, b >= 0
        rows = np.concatenate([a[first], b[second], a[within], b[within]])
        columns = np.concatenate([a[first], b[second], b[within], a[within]])
        signs = np.repeat([1.0, -1.0], [first.sum() + second.sum(), 2 * within.sum()])
        of = np.concatenate([edge[first], edge[second], edge[within], edge[within]])
        where, slot = np.unique(columns * size + rows, return_inverse=True)
        self._values = sparse.csr_matrix((signs, (slot, of)), (len(where), len(edge)))
        starts = np.searchsorted(where // size, np.arange(size + 1))
        self.matrix = sparse.csc_matrix((np.zeros(len(where)), where % size, starts), (size, size))
        self._right = [self._right_side(a, b, axis, size) for axis in range(2)]

    def _right_side(self, a: np.ndarray, b: np.ndarray, axis: int, size: int) -> sparse.csr_matrix:
        edge, uv = np.arange(len(self.edges)), self._border[:, axis]
        to_b, to_a = (a >= 0) & (b < 0), (b >= 0) & (a < 0)
        rows = np.concatenate([a[to_b], b[to_a]])
        known = np.concatenate([uv[self.edges[to_b, 1]], uv[self.edges[to_a, 0]]])
        return sparse.csr_matrix((known, (rows, np.concatenate([edge[to_b], edge[to_a]]))), (size, len(edge)))

    def equations(self, points: np.ndarray) -> tuple[sparse.csc_matrix, np.ndarray]:
        """The matrix and both right-hand sides of a pose under the rule unit."""
        density = 1 / np.linalg.norm(points[self.edges[:, 0]] - points[self.edges[:, 1]], axis=1)
        self.matrix.data[:] = self._values @ density
        return self.matrix, np.column_stack([side @ density for side in self._right])

    def whole(self, solved: np.ndarray) -> np.ndarray:
        uv = self._border.copy()
        uv[self.free] = solved
        return uv


# ---- Solvers ----


class Spsolve:
    def __init__(self, matrix: sparse.csc_matrix):
        pass

    def solve(self, matrix: sparse.csc_matrix, right: np.ndarray) -> np.ndarray:
        return linalg.spsolve(matrix, right)


class Splu(Spsolve):
    """SuperLU, which is told that the matrix is symmetric and positive."""

    def solve(self, matrix: sparse.csc_matrix, right: np.ndarray) -> np.ndarray:
        options = {"SymmetricMode": True}
        return linalg.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0, options=options).solve(right)


class Cholmod:
    def __init__(self, matrix: sparse.csc_matrix):
        from sksparse.cholmod import analyze

        self._factor = analyze(matrix)

    def solve(self, matrix: sparse.csc_matrix, right: np.ndarray) -> np.ndarray:
        self._factor.cholesky_inplace(matrix)
        return self._factor(right)


# ---- Locators ----


def by_trifinder(uv: np.ndarray, triangles: np.ndarray, asked: np.ndarray) -> np.ndarray:
    from matplotlib.tri import Triangulation

    return Triangulation(uv[:, 0], uv[:, 1], triangles).get_trifinder()(asked[:, 0], asked[:, 1])


def by_igl(uv: np.ndarray, triangles: np.ndarray, asked: np.ndarray) -> np.ndarray:
    import igl

    tree, flat = igl.AABB(), _in_space(uv)
    tree.init(flat, triangles)
    return tree.squared_distance(flat, triangles, _in_space(asked))[1].astype(np.int64)


def by_embree(uv: np.ndarray, triangles: np.ndarray, asked: np.ndarray) -> np.ndarray:
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    TriangleMesh(scene, _in_space(uv).astype(np.float32), triangles.astype(np.int32))
    rays = (_in_space(asked) + np.array([0, 0, 1])).astype(np.float32)
    return scene.run(rays, np.tile(np.array([0, 0, -1], np.float32), (len(asked), 1))).astype(np.int64)


def _in_space(uv: np.ndarray) -> np.ndarray:
    return np.column_stack([uv, np.zeros(len(uv))])


_SOLVERS = {"spsolve": Spsolve, "splu": Splu, "cholmod": Cholmod}
_LOCATORS = {"trifinder": by_trifinder, "igl": by_igl, "embree": by_embree}


class Peer:
    """A solver and a locator by name."""

    def __init__(self, solver: str, locator: str):
        self._solver, self._locate = _SOLVERS[solver], _LOCATORS[locator]

    def begin(self, patch: Patch) -> None:
        self._net, self._triangles = Net(patch), patch.triangles().astype(np.int64)
        self._system = self._solver(self._net.equations(patch.rest)[0])
        self.rest_embedding = self._embed(patch.rest)
        self._asked = np.ascontiguousarray(self.rest_embedding[self._net.free])

    def frame(self, points: np.ndarray) -> Slid:
        times = [time.thread_time()]
        uv = self._embed(points)
        times.append(time.thread_time())
        faces = self._found(uv)
        times.append(time.thread_time())
        corners = self._triangles[faces]
        slid = points.astype(np.float64)
        slid[self._net.free] = np.einsum("ij,ijk->ik", _barycentric(uv[corners], self._asked), slid[corners])
        times.append(time.thread_time())
        stages = dict(zip(("embed", "locate", "interpolate"), np.diff(times).tolist(), strict=True))
        return Slid(stages, uv, slid.astype(np.float32))

    def _embed(self, points: np.ndarray) -> np.ndarray:
        return self._net.whole(self._system.solve(*self._net.equations(points.astype(np.float64))))

    def _found(self, uv: np.ndarray) -> np.ndarray:
        """Places a few points that rounding put between triangles: each in the one that it is least outside of."""
        faces = self._locate(uv, self._triangles, self._asked)
        for missed in np.flatnonzero(faces < 0):
            everywhere = np.broadcast_to(self._asked[missed], (len(self._triangles), 2))
            faces[missed] = np.argmax(_barycentric(uv[self._triangles], everywhere).min(axis=1))
        return faces


def _barycentric(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    a, b, c = (corners[:, k] - points for k in range(3))
    areas = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], 1)
    return areas / areas.sum(axis=1, keepdims=True)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


class Eigen:
    """Eigen's LDL^T, and a walk like ours, in C++: the library that eigen.cpp makes."""

    def __init__(self, library: str):
        self._library = ctypes.CDLL(library)
        self._library.eigen_create.restype = ctypes.c_void_p

    def begin(self, patch: Patch) -> None:
        self._faces = np.ascontiguousarray(patch.triangles(), np.int32)
        self._size = len(patch.rest)
        rest, border = patch.rest.astype(np.float32), np.ascontiguousarray(patch.border)
        counts = ctypes.c_int(self._size), ctypes.c_int(len(self._faces))
        self._made = ctypes.c_void_p(
            self._library.eigen_create(*counts, _pointer(self._faces), _pointer(rest), _pointer(border))
        )
        self.rest_embedding = np.empty((self._size, 2))
        self._library.eigen_rest(self._made, _pointer(self.rest_embedding))

    def frame(self, points: np.ndarray) -> Slid:
        uv, slid, seconds = np.empty((self._size, 2)), np.empty((self._size, 3), np.float32), np.empty(3)
        given = np.ascontiguousarray(points, np.float32)
        self._library.eigen_frame(self._made, *map(_pointer, (given, uv, slid, seconds)))
        return Slid(dict(zip(("embed", "locate", "interpolate"), seconds.tolist(), strict=True)), uv, slid)


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
