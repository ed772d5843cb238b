import numpy as np
import pytest
from matplotlib.figure import Figure

from data_synth.lightings import nine_points
from data_synth.shapes import bumpy_sphere
from harmface.conventions import linear_to_srgb
from harmface.errors import ArgumentError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.inverse import estimate_light
from harmface.light import EnvironmentMap, published_probe
from harmface.pca import analytic_pca, attached_shadow_pca
from harmface.recognition import SubjectClassifier, enroll
from harmface.rendering import harmonic_irradiance
from harmface.reproduce.synthetic import light_of, mesh_of, probe_images
from harmface.stereo import photometric_stereo
from harmface.viz import interactive, plot, write_figure


@pytest.fixture(scope="module")
def mesh():
    return mesh_of(bumpy_sphere(32))


@pytest.fixture(scope="module")
def results(mesh):
    view = gbuffer(mesh, frame_orthographic(mesh, 32))
    lights = light_of(nine_points())
    images = probe_images(mesh, nine_points(), 32, np.random.default_rng(0))
    gallery = enroll({"a$b": mesh, "<b>": mesh.rotated(np.diag([-1.0, 1, -1]))}, size=24)
    return {
        "map": EnvironmentMap.from_image(np.ones((8, 16, 3))),
        "lights": lights,
        "mesh": mesh,
        "view": view,
        "estimate": estimate_light(images[0], view.normals),
        "stereo": photometric_stereo(images, view.mask),
        "analytic": analytic_pca(view.normals[view.mask]),
        "empirical": attached_shadow_pca(
            view.normals, lights.directions, view.mask.astype(float), count=3
        ),
        "gallery": gallery,
        "classifier": SubjectClassifier.from_gallery(gallery, "9d"),
    }


KINDS = (
    "map",
    "lights",
    "mesh",
    "view",
    "estimate",
    "stereo",
    "analytic",
    "empirical",
    "gallery",
    "classifier",
)


@pytest.mark.parametrize("kind", KINDS)
def test_one_line_draws_any_result(results, kind, tmp_path):
    figure = plot(results[kind])
    assert isinstance(figure, Figure)
    write_figure(tmp_path / "figure.png", figure)
    assert any(axes.images or axes.collections for axes in figure.axes)
    told = [axes.get_title() + axes.get_title("left") for axes in figure.axes]
    assert any(told) or figure.get_suptitle()


def test_the_error_of_stereo_has_a_scale_in_degrees(results):
    titles = [axes.get_title() for axes in plot(results["stereo"]).axes]
    assert "expected error of a normal, degrees" in titles
    assert len(titles) == 5  # four pictures and a colour bar


def test_the_photograph_of_an_estimate_is_shown_as_it_was_given(results):
    normals = results["view"].normals
    image = np.where(results["view"].mask, np.arange(32**2).reshape(32, 32) / 1024, 0)
    titles = {axes.get_title(): axes for axes in plot(estimate_light(image, normals)).axes}
    shown = np.asarray(titles["photograph"].images[0].get_array())
    assert shown.shape == (32, 32)
    assert (np.diff(shown.ravel()[np.argsort(image, axis=None)]) >= 0).all()
    assert shown[np.unravel_index(image.argmax(), image.shape)] == pytest.approx(1)


def test_other_things_are_refused(results):
    normals = results["view"].normals[results["view"].mask]
    with pytest.raises(ArgumentError, match="of a picture"):
        plot(estimate_light(np.ones(len(normals)), normals))
    with pytest.raises(ArgumentError, match=r"one of .*EnvironmentMap.*got int"):
        plot(3)


def test_a_plotter_shows_radiosity_and_its_sliders_move_the_light(mesh):
    light = published_probe("grace")
    plotter = interactive(mesh, light, off_screen=True)
    surface = plotter.mesh

    def ratio(light):
        expected = mesh.albedo * harmonic_irradiance(light, mesh.normals).T
        top = 0.95 / np.percentile(mesh.albedo * first, 99.5)
        return linear_to_srgb(np.clip(top * expected, 0, 1))

    first = harmonic_irradiance(light, mesh.normals).T
    np.testing.assert_allclose(surface["colour"], ratio(light), atol=1e-6)
    slider = plotter.widgets.slider_widgets[6]
    slider.GetRepresentation().SetValue(0.3)
    slider.InvokeEvent("InteractionEvent")
    slider.InvokeEvent("EndInteractionEvent")
    moved = light.copy()
    moved[:, 6] += 0.3 - light[:, 6].mean()
    np.testing.assert_allclose(surface["colour"], ratio(moved), atol=1e-6)
    plotter.close()
    with pytest.raises(ArgumentError, match="at least nine coefficients"):
        interactive(mesh, np.ones((3, 4)))
