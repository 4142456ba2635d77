"""The pictures of a study as a self-contained page, by Bokeh: zoom, values at the pointer, linked selection."""

from __future__ import annotations

from html import escape

import numpy as np
from bokeh.embed import file_html
from bokeh.layouts import column, gridplot
from bokeh.layouts import row as side_by_side
from bokeh.models import (
    BasicTicker,
    ColorBar,
    ColumnDataSource,
    Div,
    HoverTool,
    LinearColorMapper,
    TabPanel,
    Tabs,
    Whisker,
)
from bokeh.models.ui import UIElement
from bokeh.plotting import figure
from bokeh.resources import INLINE
from results import Results, bins

BLUE, ORANGE, RED, GREY = "#2f6db3", "#d9822b", "#b3392f", "#c4c9cf"
TOOLS = "pan,box_zoom,wheel_zoom,reset,save"
SELECTION = "box_select,lasso_select,box_zoom,wheel_zoom,reset"
MOST = 8
"""Largest number of columns of a scatter matrix."""
NARROW = 300
"""Smallest width of a plot that fills the width of the page [px]: that of a small phone without its margins."""
TEMPLATE = """
{% block preamble %}
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <style>
      body { padding: 8px }
      @media (prefers-color-scheme: dark) {
        html { background: #16181b }
        body { filter: invert(0.91) hue-rotate(180deg) }
      }
    </style>
{% endblock %}
"""
"""A page for screens of any width; white becomes dark where the reader prefers that, and colours stay."""


def html(results: Results) -> str:
    """The page."""
    panels: list[tuple[str, UIElement | None]] = [
        ("Main effects", main_effects(results)),
        ("Scatter matrix", scatter_matrix(results)),
        ("Distributions", distributions(results)),
        ("Response surfaces", response_surfaces(results)),
        ("Sobol's indices", sobol_indices(results)),
        ("Progress of the search", progress(results)),
    ]
    tabs = Tabs(tabs=[TabPanel(child=child, title=title) for title, child in panels if child is not None])
    name = results.plan["name"]
    text = f"<b>{escape(name)}</b>: {results.runs} runs, {results.failed} failed"
    head = Div(text=text, styles={"font-family": "system-ui, sans-serif", "font-size": "14px"})
    tabs.sizing_mode = "stretch_width"
    whole = column(head, tabs, sizing_mode="stretch_width")
    return file_html(whole, INLINE, f"Study {name}", template=TEMPLATE)


def wrapped(plots: list[figure]) -> UIElement:
    """Plots side by side, in more rows on a narrow page."""
    for own in plots:
        own.max_width, own.min_width, own.sizing_mode = own.width, min(own.width, NARROW), "scale_width"
    return side_by_side(*plots, styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")


def matrix(rows: list[list[figure]]) -> UIElement:
    """Plots in rows and columns, with a horizontal scroll bar on a narrow page."""
    return column(gridplot(rows, merge_tools=True), styles={"overflow-x": "auto"}, sizing_mode="stretch_width")


def plot(x: str, y: str, width: int = 300, height: int = 240, tools: str = TOOLS) -> figure:
    """An empty plot with names."""
    own = figure(width=width, height=height, tools=tools, x_axis_label=x, y_axis_label=y)
    own.toolbar.autohide = True
    for axis in (*own.xaxis, *own.yaxis):
        axis.ticker = BasicTicker(desired_num_ticks=3 if width < NARROW else 5)
    return own


def main_effects(results: Results) -> UIElement | None:
    """Mean of each response over each factor, with the standard deviation of the runs there."""
    if not results.factors:
        return None
    rows: list[UIElement] = []
    for response in results.responses:
        row, shared = [], None
        for factor in results.factors:
            effect = results.effect(factor, response)
            label = results.labels[factor]
            own = plot(label, results.labels[response])
            if shared is not None:
                own.y_range = shared
            shared = own.y_range
            low, high = effect.means - effect.deviations, effect.means + effect.deviations
            data = {"x": effect.places, "mean": effect.means, "low": low, "high": high, "s": effect.deviations}
            source = ColumnDataSource(data)
            own.varea("x", "low", "high", source=source, fill_color=BLUE, fill_alpha=0.18)
            own.line("x", "mean", source=source, line_color=BLUE, line_width=2)
            points = own.scatter("x", "mean", source=source, color=BLUE, size=5)
            tips = [
                (label, "@x{0.000000}"),
                ("mean", "@mean{0.000000}"),
                ("deviation", "@s{0.000000}"),
            ]
            own.add_tools(HoverTool(renderers=[points], tooltips=tips))
            row.append(own)
        rows.append(wrapped(row))
    return column(*rows, sizing_mode="stretch_width")


def scatter_matrix(results: Results) -> UIElement | None:
    """Factors and responses against each other; a selection in one panel applies to all panels."""
    if not results.factors:
        return None
    index = results.thinned()
    columns = {**results.factors, **results.responses}
    names = list(columns)
    if len(names) > MOST:
        strongest = results.strongest(next(iter(results.responses)))
        outputs = list(results.responses)[: MOST // 2]
        names = [*strongest[: MOST - len(outputs)], *outputs]
    data = {f"c{k}": columns[name][index] for k, name in enumerate(names)} | {"run": results.numbers[index]}
    source = ColumnDataSource(data)
    rows = []
    for i, y in enumerate(names):
        row = []
        for j, x in enumerate(names[:i]):
            own = plot(results.labels[x], results.labels[y], 190, 170, SELECTION)
            points = own.scatter(f"c{j}", f"c{i}", source=source, size=3, color=BLUE, alpha=0.5)
            points.nonselection_glyph.fill_color = GREY
            points.nonselection_glyph.line_color = GREY
            tips = [(results.labels[name], f"@c{k}") for k, name in enumerate(names)]
            own.add_tools(HoverTool(tooltips=[("run", "@run"), *tips]))
            row.append(own)
        if row:
            rows.append(row)
    return matrix(rows)


def distributions(results: Results) -> UIElement:
    """Histogram of each response, with mean and quantiles."""
    plots = []
    for name, values in results.responses.items():
        values = values[np.isfinite(values)]
        heights, edges = np.histogram(values, bins=bins(values))
        label = results.labels[name]
        own = plot(label, "runs", 420, 300)
        source = ColumnDataSource({"n": heights, "left": edges[:-1], "right": edges[1:]})
        bars = own.quad(
            left="left", right="right", top="n", bottom=0, source=source, fill_color=BLUE, line_color="white"
        )
        own.add_tools(HoverTool(renderers=[bars], tooltips=[(label, "@left to @right"), ("runs", "@n")]))
        own.vspan(np.quantile(values, (0.01, 0.5, 0.99)), line_color=ORANGE, line_width=2)
        own.title.text = f"mean {values.mean():.6g}, deviation {values.std():.3g}\nlines: 1 %, 50 %, 99 %"
        own.title.text_font_size = "9pt"
        plots.append(own)
    return wrapped(plots)


def response_surfaces(results: Results) -> UIElement | None:
    """Each response over its two strongest factors."""
    plots = []
    for name in results.responses:
        surface = results.surface(name)
        if surface is None:
            continue
        x_label, y_label = (results.labels[factor] for factor in surface.names)
        own = plot(x_label, y_label, 440, 340)
        mapper = LinearColorMapper("Viridis256", low=np.nanmin(surface.values), high=np.nanmax(surface.values))
        x, y = surface.x, surface.y
        image = own.image(
            [surface.values], x=x[0], y=y[0], dw=x[-1] - x[0], dh=y[-1] - y[0], color_mapper=mapper, level="image"
        )
        label = results.labels[name]
        tips = [(x_label, "$x{0.000000}"), (y_label, "$y{0.000000}"), (label, "@image{0.000000}")]
        own.add_tools(HoverTool(renderers=[image], tooltips=tips))
        own.add_layout(ColorBar(color_mapper=mapper), "right")
        own.title.text, own.title.text_font_size = f"{label}\n{surface.how}", "9pt"
        plots.append(own)
    return wrapped(plots) if plots else None


def sobol_indices(results: Results) -> UIElement | None:
    """First and total indices of each response."""
    plots = []
    for name in results.responses:
        indices = results.indices(name)
        if indices is None:
            continue
        own = plot("index", "", 460, 150 + 46 * len(indices.names))
        own.title.text = f"{name}, {indices.points} points"
        places = np.arange(len(indices.names))[::-1] + 0.5
        parts = (
            ("first order", BLUE, 0.2, indices.first, indices.first_interval),
            ("total", ORANGE, -0.2, indices.total, indices.total_interval),
        )
        for label, colour, shift, values, interval in parts:
            y = places + shift
            data = {"y": y, "value": values, "low": values - interval, "high": values + interval, "n": indices.names}
            source = ColumnDataSource(data)
            bars = own.hbar(
                y="y", right="value", height=0.38, source=source, fill_color=colour, line_color=None, legend_label=label
            )
            own.add_layout(Whisker(dimension="width", base="y", lower="low", upper="high", source=source))
            tips = [("factor", "@n"), (label, "@value{0.0000}"), ("interval", "@low{0.0000} to @high{0.0000}")]
            own.add_tools(HoverTool(renderers=[bars], tooltips=tips))
        own.yaxis.ticker = places
        own.yaxis.major_label_overrides = dict(zip(places, indices.names, strict=True))
        own.legend.orientation = "horizontal"
        own.add_layout(own.legend[0], "above")
        plots.append(own)
    return wrapped(plots) if plots else None


def progress(results: Results) -> UIElement | None:
    """Objective of the designs in the order in which they were evaluated, and the best so far."""
    name = results.plan["minimise"] or results.plan["maximise"]
    if name not in results.responses or results.violation is None:
        return None
    y, kept = results.responses[name], results.violation <= 0.0
    own = plot("evaluation", results.labels[name], 900, 460)
    own.scatter(results.numbers[~kept], y[~kept], color=GREY, size=3, legend_label="exceeds a limit")
    own.scatter(results.numbers[kept], y[kept], color=BLUE, size=4, legend_label="satisfies all limits")
    if kept.any():
        best = np.minimum if results.plan["minimise"] else np.maximum
        own.step(
            results.numbers[kept], best.accumulate(y[kept]), mode="after", color=RED, line_width=2, legend_label="best"
        )
    own.add_tools(HoverTool(tooltips=[("evaluation", "@x"), (name, "@y{0.000000}")]))
    return wrapped([own])
