"""Photographs that a gallery's own people are tried with, without having been enrolled."""

from dataclasses import replace

import numpy as np

from harmface.recognition.gallery import Gallery
from harmface.recognition.whitened import FEWEST_PEOPLE

FOLDS = 3
"""Parts of a gallery of photographs, each compared with the others to see how sure a name is."""

Try = tuple[Gallery, np.ndarray, np.ndarray]
"""A gallery, probes of its people, and the number of the subject that each of them shows."""


def tries(gallery: Gallery, learns: bool) -> list[Try]:
    """Deal every subject's photographs out to folds; each is to be compared with the others.

    With fewer photographs of somebody, one alone may be left of them, or none. Other people
    who were learned from stand in, if there are any, half of them learned from the other half:
    they are known under more light.

    Parameters
    ----------
    gallery
        Photographs.
    learns
        Whether the method learns from other people.

    Returns
    -------
    list of tuple
        Galleries with probes of their people; none if there are too few photographs.
    """
    which = gallery.which
    stand_ins = _stand_ins(gallery) if learns else []
    if stand_ins or np.bincount(which).min() < FOLDS:
        return stand_ins
    fold = np.zeros_like(which)
    for subject in np.unique(which):
        own = which == subject
        fold[own] = np.arange(own.sum()) % FOLDS
    images = gallery.photographs.images
    return [
        (gallery.chosen(fold != each), images[fold == each], which[fold == each])
        for each in range(FOLDS)
    ]


def _stand_ins(gallery: Gallery) -> list[Try]:
    """Enroll the best-lit photographs of other people, as many of each as of the subjects."""
    others = gallery.others
    people = np.unique([] if others is None else others.subjects)
    half, few = len(people) // 2, int(np.bincount(gallery.which).min())
    if others is None or half < FEWEST_PEOPLE:
        return []
    found = []
    for part in (people[:half], people[half : 2 * half]):
        own = others.chosen(np.isin(others.subjects, part))
        light = own.images.mean(axis=(1, 2))
        enrolled = np.zeros(len(light), bool)
        for person in part:
            mine = np.flatnonzero(own.subjects == person)
            enrolled[mine[np.argsort(-light[mine])[:few]]] = True
        known = replace(
            gallery,
            photographs=own.chosen(enrolled),
            lights=None,
            relit=own.chosen(light < 0),
            others=others.chosen(~np.isin(others.subjects, part)),
        )
        probes = own.chosen(~enrolled)
        found.append((known, probes.images, np.searchsorted(part, probes.subjects)))
    return found
