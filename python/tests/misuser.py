"""Mistakes that mypy and pyright have to find, one in each of these lines."""

import numpy as np

import batten

square = np.zeros((4, 2))
batten.refine(square, levels="five")
batten.refine(square, levls=5)
batten.refine(square, ends="reflects")
batten.refine(square).no_such_name
batten.refine_mesh(square, square, scheme="lop")
batten.Motion([0, 1], square, ends="free")
batten.decimate(square, square, vertices="ten")
batten.Mesh.read("a.obj", repairs=True)
batten.fit_surface(square, tolerence=0.1)
batten.read_points("a.laz", clases=2)
batten.no_such_function()
