// What took most of a redraw in BokehJS and this page does without. Where a later BokehJS has no such place, nothing is changed.
"use strict";
const home = (thing, name) => { // where a method stands that is inherited
  while (thing && !Object.hasOwn(thing, name)) thing = Object.getPrototypeOf(thing);
  return thing;
};

function quick() {
  for (const figure of figures()) {
    const view = Bokeh.index.find_one(figure), visuals = home(view?.visuals?.background_fill, "_get_css_value");
    if (visuals) visuals._get_css_value = () => ""; // asked for at each stroke: variables of a style sheet, of which there are none
    const paint = view?.repaint, span = view?._range_manager;
    if (paint && span?.update_dataranges && view.pause && view.unpause) {
      view.repaint = function () { // ranges that change while a chart is painted have it painted twice
        if (span.invalidate_dataranges) {
          const all = this._invalidate_all;
          this.pause();
          span.update_dataranges();
          this.unpause(true);
          this._invalidate_all = all; // what lies over the curves need not be painted again
        }
        paint.call(this);
      };
    }
    for (const [each, own] of view?.renderer_views ?? []) {
      if (each.type === "GlyphRenderer" && own.update_position) own.update_position = () => {}; // of an element that shows nothing
    }
    const side = home(view?.renderer_views?.get(figure.left[0])?.layout, "has_size_changed");
    if (side && !side.wide) { // labels of another width change nothing while they fit beside the frame
      const changed = side.has_size_changed, fits = figure.min_border_left ?? 0;
      side.has_size_changed = function () {
        return changed.call(this) && !(this.panel?.is_vertical && Math.max(this.bbox.width, this._content_size().width) <= fits);
      };
      side.wide = true;
    }
    for (const each of figure.above) {
      const legend = view?.views.find_one(each), renew = legend?._render_items, sheet = home(legend?.position, "_update");
      if (renew) legend._render_items = function () { if (this._should_rerender_items !== false) renew.call(this); }; // else with all new data
      if (sheet && !sheet.same) { // the same text written again makes the browser lay out the page again
        const write = sheet._update;
        sheet._update = function (css) { if (css !== this.css) write.call(this, css); };
        sheet.same = true;
      }
    }
  }
}
