"""What may differ from one person to the next, in physical units.

Means and spreads of lengths follow the anthropometry of adult men and women taken together
([Farkas94]_); where no survey gives a figure, the range was chosen by eye.

.. [Farkas94] L. G. Farkas (ed.), *Anthropometry of the Head and Face*, Raven Press, 1994.
"""

from typing import NamedTuple


class Parameter(NamedTuple):
    """One identity parameter: the mean face's value, the population's spread and limits.

    `sex`, `weight`, `age` and `tone` are correlations with four hidden traits of the person (male
    +, heavy +, old +, dark +), so that a strong brow comes with a wide jaw more often than not.
    """

    name: str
    mean: float
    spread: float
    low: float
    high: float
    unit: str
    meaning: str
    sex: float = 0.0
    weight: float = 0.0
    age: float = 0.0
    tone: float = 0.0

    @property
    def ties(self) -> tuple[float, float, float, float]:
        """Correlations with sex, weight, age and tone."""
        return self.sex, self.weight, self.age, self.tone


def _p(
    name: str, mean: float, spread: float, unit: str, meaning: str,
    low: float | None = None, high: float | None = None, **traits: float,
) -> Parameter:  # fmt: skip
    low = mean - 3 * spread if low is None else low
    high = mean + 3 * spread if high is None else high
    return Parameter(name, mean, spread, low, high, unit, meaning, **traits)


SKULL = (
    _p("head_length", 193, 8.0, "mm", "glabella to the back of the head", sex=0.6),
    _p("head_breadth", 152, 6.2, "mm", "greatest breadth above the ears", sex=0.5),
    _p("vault_height", 113, 5.5, "mm", "crown above the eyes", sex=0.3),
    _p("bizygomatic_breadth", 141, 6.4, "mm", "breadth over the cheekbones", sex=0.5, weight=0.4),
    _p("bigonial_breadth", 116, 8, "mm", "breadth at the angles of the jaw", sex=0.6, weight=0.5),
    _p("gonial_drop", 0, 4.0, "mm", "angle of the jaw lower (+) or higher", sex=0.3),
    _p("neck_breadth", 110, 10, "mm", "breadth of the neck", sex=0.65, weight=0.5),
    _p("neck_depth", 111, 9, "mm", "depth of the neck", sex=0.6, weight=0.5),
    _p("forehead_slope", 0, 4.0, "mm", "upper forehead set back (+) or steep", sex=0.5),
    _p("forehead_bulge", 0, 1.5, "mm", "middle of the forehead rounded out", sex=-0.3),
    _p("brow_ridge", 3.2, 1.8, "mm", "bone over the eyes", sex=0.7),
    _p("brow_height", 0, 1.8, "mm", "eyebrows higher (+) or lower", sex=-0.5),
    _p("larynx", 1.2, 1.2, "mm", "Adam's apple", low=0, high=5, sex=0.8),
    _p("neck_cord", 1.2, 1.0, "mm", "the muscles down the sides of the neck", weight=-0.4),
    _p("temple_hollow", 2.0, 1.2, "mm", "depth of the temples", weight=-0.5, age=0.3),
)
FACE = (
    _p("nose_height", 51, 3.4, "mm", "nasion to subnasale", sex=0.45, age=0.2),
    _p("upper_lip_length", 21.5, 2.2, "mm", "subnasale to the mouth line", sex=0.4, age=0.3),
    _p("lower_face_height", 46, 3.9, "mm", "mouth line to under the chin", sex=0.55),
    _p("midface_protrusion", 0, 2.4, "mm", "jaws forward (+) or back"),
    _p("chin_protrusion", 0, 2.8, "mm", "chin forward (+) or back", sex=0.3),
    _p("chin_breadth", 20, 3.0, "mm", "half breadth of the chin's boss", sex=0.6),
    _p("chin_cleft", 0.2, 0.5, "mm", "furrow in the chin", low=0, high=1.6, sex=0.3),
    _p("mentolabial_depth", 1.5, 0.9, "mm", "furrow between lip and chin", sex=0.2),
    _p("face_flatness", 0, 2.2, "mm", "sides of the face forward (+) or back"),
    _p("cheekbone_prominence", 4.0, 1.6, "mm", "cheekbones forward and out"),
    _p("cheek_fullness", 0, 3.0, "mm", "flesh of the cheeks", weight=0.8, age=-0.2),
    _p("submental_fullness", 0, 4.0, "mm", "flesh under the chin", weight=0.7, age=0.3),
    _p("nasolabial_depth", 0.6, 0.5, "mm", "fold from nose to mouth", low=0, high=3.0, age=0.7),
    _p("jowl", 0.3, 1.0, "mm", "sagging at the jaw line", weight=0.4, age=0.6),
)
EYES = (
    _p("intercanthal_width", 32.8, 2.6, "mm", "between the inner corners of the eyes"),
    _p("fissure_length", 30.0, 1.4, "mm", "inner to outer corner of an eye", sex=0.2),
    _p("fissure_height", 10.2, 1.1, "mm", "between the lids", sex=-0.3, age=-0.3),
    _p("canthal_tilt", 3.5, 2.0, "degree", "outer corner above the inner", sex=-0.2, age=-0.3),
    _p("eye_depth", 0, 1.5, "mm", "eyeballs deep (+) or prominent", sex=0.3),
    _p("lid_fold", 1.2, 0.8, "mm", "skin hanging over the upper lid", low=-0.6, high=4, age=0.5),
    _p("eye_bag", 0.5, 0.6, "mm", "fullness under the eye", low=0, high=3, age=0.6),
)
NOSE = (
    _p("nose_breadth", 34.5, 3.4, "mm", "across the wings", sex=0.45),
    _p("nose_protrusion", 19.5, 2.3, "mm", "tip in front of subnasale", sex=0.35),
    _p("bridge_height", 4.5, 1.8, "mm", "root of the nose above the face", sex=0.3),
    _p("bridge_breadth", 13.0, 1.5, "mm", "half breadth at mid height", sex=0.2),
    _p("nasal_hump", 0, 1.2, "mm", "convex (+) or concave ridge", sex=0.3),
    _p("tip_drop", 0, 1.8, "mm", "tip lower (+) or turned up", sex=0.2, age=0.4),
    _p("tip_breadth", 9.0, 1.2, "mm", "half breadth of the tip", sex=0.2),
    _p("wing_size", 5.5, 0.9, "mm", "bulge of the wings"),
)
MOUTH = (
    _p("mouth_width", 52, 3.7, "mm", "corner to corner", sex=0.3),
    _p("upper_vermilion", 8.0, 1.6, "mm", "height of the upper lip's red", age=-0.4, sex=-0.2),
    _p("lower_vermilion", 9.5, 1.7, "mm", "height of the lower lip's red", age=-0.4, sex=-0.2),
    _p("lip_fullness", 5.2, 1.0, "mm", "bulge of the lips", age=-0.4, sex=-0.2),
    _p("cupids_bow", 1.3, 0.7, "mm", "dip of the upper lip's edge"),
    _p("philtrum_depth", 1.1, 0.5, "mm", "groove under the nose"),
    _p("mouth_curve", 0, 1.1, "mm", "corners up (+) or down", age=-0.2),
)
EARS = (
    _p("ear_height", 61, 4.3, "mm", "top to lobe", sex=0.3, age=0.4),
    _p("ear_breadth", 34, 2.5, "mm", "breadth of the ear", sex=0.3),
    _p("ear_flare", 28, 7, "degree", "angle between ear and head"),
    _p("ear_level", 0, 2.5, "mm", "ears higher (+) or lower"),
    _p("lobe_size", 0, 2.5, "mm", "long (+) or short lobes", age=0.3),
)
ASYMMETRY = (
    _p("nose_deviation", 0, 1.0, "mm", "tip of the nose to the right"),
    _p("mouth_shift", 0, 1.0, "mm", "mouth to the right"),
    _p("mouth_tilt", 0, 0.8, "mm", "right corner above the left"),
    _p("eye_level_difference", 0, 0.7, "mm", "right eye above the left"),
    _p("jaw_shift", 0, 1.6, "mm", "chin to the right"),
    _p("brow_difference", 0, 0.8, "mm", "right brow above the left"),
    _p("ear_difference", 0, 1.6, "mm", "right ear above the left"),
)
SURFACE = (
    _p("hair_volume", 7, 4.5, "mm", "thickness of the hair", low=0, high=22, sex=-0.55, age=-0.2),
    _p("hair_length", 0, 42, "mm", "below the nape", low=0, high=90, sex=-0.75),
    _p("hairline", 72, 5.5, "mm", "height of the hairline above the eyes", sex=0.4, age=0.5),
    _p("temple_recession", 8, 5, "mm", "hairline back", low=0, high=28, sex=0.5, age=0.5),
    _p("skin_relief", 0, 0.07, "mm", "uneven skin, root mean square", low=0, high=0.25, age=0.5),
    _p("forehead_lines", 0, 0.22, "mm", "depth of the lines", low=0, high=0.9, age=0.8),
    _p("relief_pattern", 0, 0, "", "which pattern of unevenness, an integer", low=0, high=2**31),
)
COLOUR = (
    _p("melanin", 0.15, 0.12, "", "volume of melanosomes in the epidermis", low=0.01, high=0.43),
    _p("haemoglobin", 0.045, 0.009, "", "volume of blood in the dermis", low=0.015, high=0.08),
    _p("lip_blood", 0.6, 0.25, "", "additional redness of the lips", low=0, high=1.4, sex=-0.4),
    _p("brow_density", 0.7, 0.15, "", "cover of the eyebrows", low=0.1, high=0.95, sex=0.3),
    _p("brow_thickness", 4.2, 1.0, "mm", "half height of the eyebrows", low=1.6, high=7, sex=0.6),
    _p("stubble", 0.12, 0.2, "", "cover of the beard's shadow", low=0, high=0.7, sex=0.85),
    _p("freckles", 0.05, 0.2, "", "cover of freckles", low=0, high=0.8, tone=-0.5),
    _p("hair_melanin", 0.78, 0.3, "", "darkness of the hair", low=0.05, high=1.0, tone=0.75),
    _p("grey", 0.0, 0.2, "", "fraction of grey hairs", low=0, high=0.9, age=0.8),
    _p("iris_melanin", 0.6, 0.35, "", "darkness of the iris", low=0.0, high=1.0, tone=0.8),
    _p("hair_cover", 0.95, 0.2, "", "how much scalp the hair hides", low=0, high=1.0),
    _p("blotches", 0.0, 0.05, "", "patchy redness", low=0, high=0.15),
)

PARAMETERS: tuple[Parameter, ...] = (
    *SKULL, *FACE, *EYES, *NOSE, *MOUTH, *EARS, *ASYMMETRY, *SURFACE, *COLOUR,
)  # fmt: skip
MEAN: dict[str, float] = {q.name: float(q.mean) for q in PARAMETERS}
