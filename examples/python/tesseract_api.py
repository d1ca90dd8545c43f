"""A problem of the suite as a Tesseract, the shape that Mosaic's containers ask for
(apply, vector_jacobian_product): `tesseract build` takes this file as it is, with the
package installed in the image. PHYSINV_PROBLEM names the problem."""
import os

import physinv
from pydantic import BaseModel
from tesseract_core.runtime import Array, Differentiable, Float64, ShapeDType

problem = physinv.problem(os.environ.get("PHYSINV_PROBLEM", "sip/heat"))


class InputSchema(BaseModel):
    x: Differentiable[Array[(None, problem.shape[0]), Float64]]  # (samples, unknowns)
    given: Array[(None, problem.shape[2]), Float64]  # (samples, side input)


class OutputSchema(BaseModel):
    y: Differentiable[Array[(None, problem.shape[1]), Float64]]  # (samples, observations)


def apply(inputs: InputSchema) -> OutputSchema:
    return OutputSchema(y=problem.forward(inputs.x, inputs.given))


def vector_jacobian_product(inputs, vjp_inputs, vjp_outputs, cotangent_vector):
    assert vjp_inputs == {"x"} and vjp_outputs == {"y"}
    y, tape = problem.linearize(inputs.x, inputs.given)
    return {"x": tape.pullback(cotangent_vector["y"])}


def abstract_eval(abstract_inputs):
    samples = abstract_inputs.x.shape[0]
    return {"y": ShapeDType(shape=(samples, problem.shape[1]), dtype="float64")}
