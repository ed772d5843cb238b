"""Claims on general materials: their filters, factorisation, and principal components."""

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad
from scipy.special import eval_legendre

from harmface.conventions import degrees
from harmface.inverse import estimate_reflectance, factorize, reflected_field
from harmface.light import DistantLight, directional_lights
from harmface.pca import materials_spectrum
from harmface.reflectance import GGX, Beckmann, Lambert, Material, Phong
from harmface.rendering.reference import clamped_cosines, shown_by
from harmface.reproduce.experiment import Measurement
from harmface.sphere import fibonacci_directions, gauss_legendre, synthesize

EXPONENTS = (5, 20, 100)
ROUGHNESSES = (0.05, 0.1, 0.2, 0.3)


def phong_filter() -> Measurement:
    """Hold Phong's factors against quadrature, and two approximations against the factors."""
    degree = np.arange(13)
    figure = Figure(figsize=(9, 3))
    values, worst = [], 0.0
    for number, s in enumerate(EXPONENTS, 1):
        exact = Phong(s).radial(12)
        numeric = [
            (s + 1) * quad(lambda c, n=n, s=s: c**s * eval_legendre(n, c), 0, 1)[0] for n in degree
        ]
        worst = max(worst, float(np.abs(exact - numeric).max()))
        guesses = {
            r"$e^{-l^2/2s}$": np.exp(-(degree**2) / (2 * s)),
            r"$e^{-l(l+1)/2(s+1)}$": np.exp(-degree * (degree + 1) / (2 * (s + 1))),
        }
        values += [float(np.abs(guess - exact).max()) for guess in guesses.values()]
        axes = figure.add_subplot(1, 3, number)
        axes.plot(degree, exact, "ko", ms=4, label="exact")
        for name, guess in guesses.items():
            axes.plot(degree, guess, label=name)
        axes.set(xlabel="degree $l$", title=f"exponent {s}")
    figure.axes[0].legend(frameon=False)
    figure.tight_layout()
    return Measurement(
        [*values[::2], *values[1::2], worst],
        "Largest error over degrees up to 12 of exp(-l^2 / 2 s), then of exp(-l (l + 1) / 2 (s + "
        "1)), for exponents 5, 20, 100; then of the recurrence against adaptive quadrature.",
        {"Phong's lobe as a filter, and two approximations of it.": figure},
    )


def microfacet_filter() -> Measurement:
    """Hold Gaussians against Beckmann's lobe along the normal, by quadrature."""
    figure = Figure(figsize=(9, 2.8))
    errors = []
    for number, sigma in enumerate(ROUGHNESSES, 1):
        last = int(3 / sigma)
        degree = np.arange(last + 1)
        factors = Beckmann(sigma).radial(last)
        factors = factors / factors[0]
        guesses = {
            r"$e^{-(\sigma l)^2}$": np.exp(-((sigma * degree) ** 2)),
            r"$e^{-\sigma^2 l(l+1)}$": np.exp(-(sigma**2) * degree * (degree + 1)),
        }
        errors.append([float(np.abs(guess - factors).max()) for guess in guesses.values()])
        axes = figure.add_subplot(1, len(ROUGHNESSES), number)
        axes.plot(degree, factors, "k.", ms=4, label="quadrature")
        for name, guess in guesses.items():
            axes.plot(degree, guess, label=name)
        axes.set(xlabel="degree $l$", title=rf"$\sigma$ = {sigma}")
    figure.axes[0].legend(frameon=False, fontsize=7)
    figure.tight_layout()
    plain, better = np.transpose(errors)
    return Measurement(
        [*plain.tolist(), *better.tolist()],
        f"Roughness {', '.join(map(str, ROUGHNESSES))}, seen along the normal, r_0 made 1: largest "
        "error of exp(-(sigma l)^2), then of exp(-sigma^2 l (l + 1)). Whichever is the better at a "
        "roughness, both are approximations; `radial` is by quadrature.",
        {"Beckmann's lobe as a filter, and two Gaussians.": figure},
    )


def glossy_terms() -> Measurement:
    """Count the terms that hold 99 % of a lobe's energy as it gets sharper."""
    exponents = np.array([1, 2, 5, 10, 20, 50, 100, 200, 500])
    roughnesses = np.array([0.8, 0.6, 0.4, 0.3, 0.2, 0.1])

    def terms(material: Material) -> int:
        # The energy of a lobe in degree l is (2l + 1) r_l^2 / (4 pi).
        degree = np.arange(301)
        energy = np.cumsum((2 * degree + 1) * material.radial(300) ** 2)
        return int((np.searchsorted(energy, 0.99 * energy[-1]) + 1) ** 2)

    phong = [terms(Phong(float(e))) for e in exponents]
    ggx = [terms(GGX(float(a))) for a in roughnesses]
    figure = Figure(figsize=(8, 3))
    for number, (x, y, name) in enumerate(
        ((exponents, phong, "Phong's exponent"), (roughnesses, ggx, "roughness of GGX")), 1
    ):
        axes = figure.add_subplot(1, 2, number)
        axes.loglog(x, y, "o-", ms=3)
        axes.set(xlabel=name, ylabel="terms")
    figure.tight_layout()
    return Measurement(
        [float(n) for n in phong],
        f"Terms (l + 1)^2 for 99 % of the energy, exponents {', '.join(map(str, exponents))}; GGX "
        f"of roughness {', '.join(map(str, roughnesses))}: {', '.join(map(str, ggx))}.",
        {"Harmonics for 99 % of a lobe's energy.": figure},
    )


class _Reciprocal(Material):
    """A material times the cosine of the outgoing direction, which makes it symmetric."""

    def __init__(self, material: Material) -> None:
        self.material = material

    def evaluate(self, incoming: np.ndarray, outgoing: np.ndarray) -> np.ndarray:
        """Return reflectance times outgoing cosine, see `Material`."""
        return np.asarray(self.material.evaluate(incoming, outgoing) * outgoing[..., 2])


def _light(max_degree: int, rng: np.random.Generator) -> np.ndarray:
    light = rng.standard_normal((max_degree + 1) ** 2) / (1 + degrees(max_degree))
    light[0] = 3
    return np.asarray(light / np.linalg.norm(light))


def factorization(max_degree: int = 5, fields: int = 20, seed: int = 0) -> Measurement:
    """Separate fields of random lights on GGX, without noise and with one per cent of it."""
    rng = np.random.default_rng(seed)
    rho = _Reciprocal(GGX(0.4)).coefficients(max_degree, max_degree)
    row, column, q = np.indices(rho.shape)
    exists = (q <= np.minimum(row, column))[degrees(max_degree)]
    exact, second, inside, found = 0.0, 0.0, [], None
    for number in range(fields):
        light = _light(max_degree, rng)
        field = reflected_field(light, rho)
        clean = factorize(field)
        exact = max(exact, float(np.abs(clean.light - light).max()))
        exact = max(exact, float(np.abs(clean.rho - rho).max() / np.abs(rho).max()))
        second = max(second, float(clean.second.max()))
        noise = 0.01 * float(np.sqrt(np.mean(field[exists] ** 2)))
        noisy = field + noise * exists * rng.standard_normal(field.shape)
        found = factorize(noisy, noise=noise, rng=number)
        known = np.isfinite(found.light_errors)
        inside += (np.abs(found.light - light) < 1.96 * found.light_errors)[known].tolist()
        known = np.isfinite(found.rho_errors) & (found.rho_errors > 0)
        inside += (np.abs(found.rho - rho) < 1.96 * found.rho_errors)[known].tolist()
    assert found is not None
    axes = (figure := Figure(figsize=(8, 3))).add_subplot()
    k = np.arange(len(light))
    axes.errorbar(k, found.light, 1.96 * found.light_errors, fmt=".", label="found, 95 %")
    axes.plot(k, light, "k_", ms=9, label="true")
    axes.set(xlabel="coefficient of the light")
    axes.legend(frameon=False)
    return Measurement(
        [exact, float(np.mean(inside))],
        f"{fields} random lights of degree {max_degree} on GGX of roughness 0.4. Without noise: "
        "largest error of light and material, as a share of the largest coefficient (second "
        f"singular values at most {second:.0e}). With 1 % of noise: share of coefficients within "
        "1.96 standard errors.",
        {"The light of the last noisy field.": figure},
    )


def brdf_conditioning(max_degree: int = 8) -> Measurement:
    """Compare the standard error of a material's degrees under a lamp and under a soft sky."""
    lamp = directional_lights(DistantLight(np.array([[0.0, 0.6, 0.8]]), np.ones(1)), max_degree)
    # A rule that is exact far beyond the degree: what high degrees hold is far below rounding.
    rule = gauss_legendre(80)
    sky = DistantLight(rule.directions, np.exp(2 * rule.directions[:, 1]) * rule.weights)
    lights = {"lamp": lamp, "sky": directional_lights(sky, max_degree)}
    rho = Phong(50).coefficients(max_degree, max_degree)
    errors = {}
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    for name, light in lights.items():
        found = estimate_reflectance(reflected_field(light, rho), light, noise=1.0)
        errors[name] = found.standard_errors[:, 0, 0]
        axes.semilogy(errors[name] / errors[name][0], "o-", ms=3, label=name)
    axes.set(xlabel="degree $l$", ylabel="error, relative to degree 0")
    axes.legend(frameon=False)
    ratio = {name: float(error[max_degree] / error[0]) for name, error in errors.items()}
    return Measurement(
        [ratio["lamp"], ratio["sky"]],
        f"Standard error of degree {max_degree} over that of degree 0. Under a lamp it is "
        "1 / sqrt(2 l + 1): each degree is determined. The sky is exp(2 y).",
        {"How well light determines a material.": figure},
    )


def materials_pca(max_degree: int = 8) -> Measurement:
    """Count components of images over light and materials, by theory and from images."""
    grid = fibonacci_directions(600)
    normals = grid[grid[:, 2] > 0.1]
    towards = np.broadcast_to([0.0, 0.0, 1.0], normals.shape)
    power = 1 / (1 + np.arange(max_degree + 1.0)) ** 2
    sets: dict[str, list[Material]] = {
        "matte": [Lambert()],
        "dull": [Lambert(), Phong(5), Phong(10)],
        "glossy": [Lambert(), Phong(5), Phong(10), Phong(20), Phong(50)],
    }
    rule = gauss_legendre(120)
    cosines = clamped_cosines(normals, rule.directions)
    rng = np.random.default_rng(0)
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    counts, gaps = [], []
    for name, materials in sets.items():
        rho = np.stack([each.coefficients(max_degree, 2 * max_degree) for each in materials])
        analytic = materials_spectrum(rho, power, normals, towards)
        images = []
        for material in materials:
            light = rng.standard_normal((1000, len(degrees(max_degree))))
            light *= np.sqrt(power)[degrees(max_degree)]
            pairs = shown_by(material, normals, towards, rule.directions, cosines) / np.pi
            images.append(synthesize(light, rule.directions) * rule.weights @ pairs)
        empirical = np.linalg.svd(np.concatenate(images), compute_uv=False) ** 2
        shares = [np.cumsum(each) / each.sum() for each in (analytic, empirical)]
        counts.append(float(np.searchsorted(shares[0], 0.99) + 1))
        first = min(40, *map(len, shares))
        gaps.append(float(np.abs(shares[0][:first] - shares[1][:first]).max()))
        shown = np.arange(1, 1 + first)
        line = axes.plot(shown, shares[0][shown - 1], label=name)[0]
        axes.plot(shown, shares[1][shown - 1], ".", ms=3, color=line.get_color())
    axes.axhline(0.99, color="0.7", lw=0.8)
    axes.set(xlabel="components", ylabel="share of variance")
    axes.legend(frameon=False)
    return Measurement(
        [max(gaps)],
        "Largest difference of cumulative shares between theory and 1,000 images of a sphere for "
        "each material, light of variance 1 / (1 + l)^2 to degree "
        f"{max_degree}, by brute force. Components for 99 %: "
        f"{', '.join(f'{n} {c:.0f}' for n, c in zip(sets, counts, strict=True))}.",
        {"Share of variance: theory (lines) and images (dots).": figure},
    )
