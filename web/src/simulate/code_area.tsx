// The text of the robot file, with syntax colours, errors at their lines, and completion of keys.
import { autocompletion, type CompletionContext, type CompletionResult } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, indentWithTab, isolateHistory } from '@codemirror/commands';
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { toml } from '@codemirror/legacy-modes/mode/toml';
import { lintGutter, setDiagnostics, type Diagnostic } from '@codemirror/lint';
import { highlightSelectionMatches, searchKeymap } from '@codemirror/search';
import { EditorState } from '@codemirror/state';
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { effect, type Signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import type { Problem } from '../types';
import { tableAt } from './toml_edit';
import { robotKeys } from './robot_keys';

const colours = HighlightStyle.define([
  { tag: tags.comment, color: 'var(--code-comment)', fontStyle: 'italic' },
  { tag: tags.string, color: 'var(--code-string)' },
  { tag: [tags.number, tags.bool, tags.atom], color: 'var(--code-number)' },
  { tag: [tags.propertyName, tags.attributeName], color: 'var(--code-key)' },
  { tag: [tags.heading, tags.standard(tags.propertyName), tags.labelName], color: 'var(--code-table)', fontWeight: '700' },
]);

const look = EditorView.theme({
  '&': { height: '100%', backgroundColor: 'var(--card)', color: 'var(--ink)' },
  '.cm-scroller': { font: '12px/18px var(--mono)' },
  '.cm-gutters': { backgroundColor: 'var(--sunk)', color: 'var(--faint)', border: '0' },
  '.cm-activeLine': { backgroundColor: 'color-mix(in srgb, var(--accent) 7%, transparent)' },
  '.cm-activeLineGutter': { backgroundColor: 'transparent' },
  '.cm-cursor': { borderLeftColor: 'var(--ink)' },
  '.cm-selectionBackground, &.cm-focused .cm-selectionBackground': { backgroundColor: 'var(--accent-soft) !important' },
  '.cm-tooltip': { backgroundColor: 'var(--card)', color: 'var(--ink)', border: '1px solid var(--line)', borderRadius: '8px' },
  '.cm-tooltip-autocomplete ul li[aria-selected]': { backgroundColor: 'var(--accent-soft)', color: 'var(--ink)' },
  '.cm-completionDetail': { color: 'var(--faint)' },
  '.cm-panels': { backgroundColor: 'var(--sunk)', color: 'var(--ink)' },
});

/// Keys of the table at the cursor; after a bracket the tables themselves.
function complete(context: CompletionContext): CompletionResult | null {
  const header = context.matchBefore(/^\s*\[+[\w.]*/);
  if (header) {
    const names = Object.keys(robotKeys).filter((n) => n !== '' && n !== 'place');
    const start = header.from + (/^\s*\[+/.exec(header.text)?.[0].length ?? 0);
    return { from: start, options: names.map((label) => ({ label, type: 'class' })) };
  }
  const word = context.matchBefore(/[\w.]*/);
  const before = context.state.doc.lineAt(context.pos).text.slice(0, context.pos - context.state.doc.lineAt(context.pos).from);
  if (!/^\s*[\w.]*$/.test(before) || !word || (word.text === '' && !context.explicit)) return null;
  const keys = robotKeys[tableAt(context.state.doc.sliceString(0, context.pos))] ?? {};
  return { from: word.from, options: Object.entries(keys).map(([label, detail]) => ({ label, detail, type: 'property', apply: `${label} = ` })) };
}

function diagnostics(state: EditorState, problems: Problem[]): Diagnostic[] {
  return problems
    .filter((p) => p.line > 0 && p.line <= state.doc.lines)
    .map((p) => {
      const line = state.doc.line(p.line);
      return { from: line.from + (/^\s*/.exec(line.text)?.[0].length ?? 0), to: line.to, severity: 'error', message: p.text };
    });
}

interface Props {
  text: Signal<string>;
  /// Changes when the text of another robot takes the place of this one.
  origin: Signal<unknown>;
  problems: Signal<Problem[]>;
  readOnly: boolean;
  onApply: () => void;
  onSave: () => void;
}

const extensions = ({ text, readOnly, onApply, onSave }: Props) => [
  lineNumbers(),
  history(),
  drawSelection(),
  highlightActiveLine(),
  highlightSelectionMatches(),
  StreamLanguage.define(toml),
  syntaxHighlighting(colours),
  autocompletion({ override: [complete] }),
  lintGutter(),
  keymap.of([{ key: 'Mod-Enter', run: () => (onApply(), true) }, { key: 'Mod-s', preventDefault: true, run: () => (onSave(), true) }, ...defaultKeymap, ...historyKeymap, ...searchKeymap, indentWithTab]),
  look,
  EditorState.readOnly.of(readOnly),
  EditorView.contentAttributes.of({ 'aria-label': 'Robot file', 'aria-describedby': 'editor-keys', 'data-testid': 'robot-file', tabindex: '0' }),
  EditorView.updateListener.of((u) => u.docChanged && (text.value = u.state.doc.toString())),
];

/// What was changed outside of the editor is a step of its own in its history, so that the steps before it are undone
/// in the text that they belong to.
function replace(view: EditorView, next: string) {
  const now = view.state.doc.toString();
  if (next === now) return;
  let [begin, end] = [0, 0];
  while (begin < Math.min(next.length, now.length) && next[begin] === now[begin]) ++begin;
  while (end < Math.min(next.length, now.length) - begin && next[next.length - 1 - end] === now[now.length - 1 - end]) ++end;
  view.dispatch({ changes: { from: begin, to: now.length - end, insert: next.slice(begin, next.length - end) }, annotations: isolateHistory.of('full') });
}

function mark(view: EditorView, problems: Problem[]) {
  const first = problems.find((p) => p.line > 0 && p.line <= view.state.doc.lines);
  view.dispatch(setDiagnostics(view.state, diagnostics(view.state, problems)));
  if (first && !view.hasFocus) view.dispatch({ effects: EditorView.scrollIntoView(view.state.doc.line(first.line).from, { y: 'center' }) });
}

export function CodeArea(props: Props) {
  const { text, origin, problems, readOnly } = props;
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    /// Without a history: nothing that was done to the text of another robot can be undone in this one.
    const fresh = () => EditorState.create({ doc: text.peek(), extensions: extensions(props) });
    const view = new EditorView({ parent: box.current!, state: fresh() });
    let shown = origin.peek();
    const stops = [
      effect(() => {
        const next = text.value;
        if (origin.value === shown) return replace(view, next);
        shown = origin.value;
        view.setState(fresh());
        mark(view, problems.peek());
      }),
      effect(() => mark(view, problems.value)),
    ];
    return () => {
      for (const stop of stops) stop();
      view.destroy();
    };
  }, [readOnly]);
  return (
    <>
      <div class="code" ref={box} />
      <p class="quiet small-print" id="editor-keys">
        Ctrl+S applies and saves. Tab indents; Esc, then Tab, leaves the text.
      </p>
    </>
  );
}
