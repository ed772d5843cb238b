"""In a notebook: mesh to basis figure, photographs to surface, gallery to answer; no more."""

import nbformat
from nbclient import NotebookClient

CELLS = (
    """
import numpy as np
from data_synth.faces import head
from data_synth.lightings import mixed, uniform_directional
from data_synth.shapes import bumpy_sphere
from harmface import geometry, recognition, rendering, stereo, viz
from harmface.conventions import luminance
from harmface.reproduce.synthetic import light_of, mesh_of, probe_images
rng = np.random.default_rng(0)
""",
    """
mesh = mesh_of(head(1, n_vertices=5000))
view = geometry.gbuffer(mesh, geometry.frame_orthographic(mesh, 64))
viz.basis_figure(rendering.harmonic_images(view.normals, luminance(view.albedo)), view.mask)
""",
    """
ball = mesh_of(bumpy_sphere())
view = geometry.gbuffer(ball, geometry.frame_orthographic(ball, 48))
lights = light_of(uniform_directional(10, rng, max_polar=60))
images = rendering.render(view, lights, albedo=luminance(view.albedo), caster=ball)
found = stereo.photometric_stereo(images / images.max(), view.mask)
depth = geometry.depth_least_squares(found.normals, found.mask)
surface = geometry.depth_to_mesh(depth, found.mask, found.albedo)
viz.stereo_figure(images, found.normals, found.albedo, depth, found.mask, surface)
""",
    """
meshes = {f"{seed}": mesh_of(head(seed, n_vertices=5000)) for seed in range(3)}
gallery = recognition.enroll(meshes, size=32, cast_shadows=False)
classifier = recognition.SubjectClassifier.from_gallery(gallery, "9d")
probe = probe_images(meshes["1"], mixed(1, rng), 32, rng)
who = classifier.predict(probe.reshape(1, -1))[0]
looks, light = classifier.explained(probe, classifier.distances(probe.reshape(1, -1)).argmin(1))
answer = viz.Explanation("probe", probe[0], [(who, looks[0])], light[0])
viz.explanation_figure([answer], gallery.mask)
""",
)


def test_figures_show_themselves_and_nothing_else_does(tmp_path):
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()
    first, *shown = notebook.cells
    assert first.outputs == []
    for cell in shown:
        (output,) = cell.outputs
        assert output.output_type == "execute_result"
        assert len(output.data["image/png"]) > 2000
