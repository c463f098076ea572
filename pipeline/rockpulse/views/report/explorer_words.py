"""The words of the part to explore, in English: those of its controls, and those that the script says."""

from __future__ import annotations

__all__ = ["WORDS"]

#: Texts by their keys; names in braces are filled in.
WORDS = {
    "title": "Explore the motion",
    "intro": "How a body moves in time under a record times a factor, by the {model} model. The motions were computed "
    "when this page was written and are stored in it: for each body under its worst record, the one with f_50 nearest "
    "to 1 and the median one, at five factors.",
    "nothing": "The results hold no accelerograms, so there is no motion to show: assess again with [records] store = "
    '"all".',
    "no_script": "This part needs JavaScript, which is switched off.",
    "body": "Body",
    "record": "Record",
    "stored_here": "Stored on this page",
    "not_stored_here": "Not stored on this page",
    "worst": "worst",
    "nearest": "f_50 nearest to 1",
    "nearest_factor": "factor nearest to 1",
    "median": "median",
    "not_stored": "The motion of {body} under {record} is not stored on this page. Draw it from the results, at any "
    "factor, by",
    "no_motion": "There is no motion of {body} under {record}: {reason}",
    "factor": "Factor on the record",
    "factor_value": "× {factor}",
    "as_recorded": "as recorded",
    "factor_10": "f_10",
    "factor_50": "f_50",
    "safety_factor": "smallest that overturns",
    "demand": "demand {name}",
    "probability": "probability of overturning {share} %",
    "probability_unknown": "probability of overturning not stored at this factor",
    "curve": "P(f), the probability that the body overturns under the record times f, read from the stored spectrum of "
    "the record and laid through the stored f_10 and f_50; dots are the factors of the slider.",
    "points": "The results hold P(f) at single factors only, the open circles; full dots are factors of the slider.",
    "no_curve": "The results hold no probability of overturning for this body and record.",
    "time": "Time",
    "speed": "Speed",
    "real_time": "real time",
    "slow": "a quarter",
    "slower": "a tenth",
    "play": "Play",
    "pause": "Pause",
    "back": "Back 0.1 s",
    "forward": "Forward 0.1 s",
    "reduced": "Your system asks for less motion, so nothing plays: step, or move the slider of time.",
    "ground": "ground acceleration [g]",
    "push": "ground acceleration",
    "rotation": "rotation θ/α_c",
    "seconds": "{time} s",
    "stretch": "{start} to {end} s of {whole} s are shown, where the body moves at one of the factors.",
    "right": "to the right",
    "left": "to the left",
    "away": "away from the wall",
    "state": "At {time} s: ground {ground} g, rotation {rotation} of α_c {side} ({degrees}°), {verdict}.",
    "state_still": "At {time} s: ground {ground} g, rotation 0, the body stands.",
    "state_fallen": "At {time} s: ground {ground} g, the body has overturned {side}.",
    "rocking": "rocking",
    "beyond": "beyond the critical angle",
    "overturns": "At this factor the body overturns.",
    "overturns_by": "At this factor the body overturns; certain from {time} s.",
    "rocks": "At this factor the body rocks and stands, peak {peak} of α_c.",
    "rest": "At this factor the body is not lifted.",
    "unresolved": "At this factor the model cannot say how the motion ends.",
    "stage": "{body}, drawn to scale, {degrees}° from upright",
    "held": "What holds or pushes the body is not drawn.",
    "triangle": "The size of the body is not known: a triangle from its corners to its centre of mass stands for it.",
    "still_moving": "It still moves when the record ends; how it ends counts what follows.",
}
