"""Options that several commands share: a dataclass in place of a long list in each of them."""

import functools
import inspect
from collections.abc import Callable
from dataclasses import fields
from typing import Any, get_type_hints


def with_options(name: str, group: type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Give a command the options that a dataclass lists, in place of one parameter.

    Parameters
    ----------
    name
        The command's parameter that takes an instance of the dataclass.
    group
        The dataclass: each field is an option, annotated as typer has them, with its default.
    """
    options = get_type_hints(group, include_extras=True)
    each_field: tuple[Any, ...] = fields(group)

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        parameters: list[inspect.Parameter] = []
        for parameter in inspect.signature(command, eval_str=True).parameters.values():
            if parameter.name == name:
                parameters += [
                    inspect.Parameter(
                        each.name,
                        inspect.Parameter.KEYWORD_ONLY,
                        annotation=options[each.name],
                        default=each.default,
                    )
                    for each in each_field
                ]
            else:
                parameters.append(parameter)

        @functools.wraps(command)
        def taking_options(**given: Any) -> Any:
            chosen = group(**{each.name: given.pop(each.name) for each in each_field})
            return command(**given, **{name: chosen})

        taking_options.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        taking_options.__annotations__ = {each.name: each.annotation for each in parameters}
        return taking_options

    return decorate
