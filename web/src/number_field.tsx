// A number field. An invalid value is explained beside it, with the allowed range; leaving the field restores the last
// valid value; what was wrong stays to be read for a while.
import { useEffect, useRef, useState } from 'preact/hooks';

export interface Range {
  from: number;
  to: number;
  open?: boolean; // the range excludes its ends
}

export function rangeText({ from, to, open }: Range, unit: string): string {
  const u = unit && ` ${unit}`;
  if (from === -Infinity && to === Infinity) return 'must be a number';
  if (to === Infinity) return `must be ${open ? 'more than' : 'at least'} ${from}${u}`;
  if (from === -Infinity) return `must be ${open ? 'less than' : 'at most'} ${to}${u}`;
  return open ? `must be more than ${from} and less than ${to}${u}` : `must be from ${from} to ${to}${u}`;
}

export function inRange(v: number, { from, to, open }: Range): boolean {
  return Number.isFinite(v) && (open ? v > from && v < to : v >= from && v <= to);
}

/// The error of a typed text.
export const wrongText = (typed: string, range: Range, unit: string) => `${typed && `${typed}: `}${rangeText(range, unit)}`;

const readFor = 6000; // ms

interface Props {
  value: number;
  range: Range;
  unit: string;
  label?: string; // if there is no surrounding <label>
  step?: number | 'any';
  disabled?: boolean;
  testId?: string;
  /// False, or a promise of it: rejected, and the last value is restored.
  onValue: (v: number) => void | boolean | Promise<boolean>;
}

export function NumberField({ value, range, unit, label, step = 'any', disabled, testId, onValue }: Props) {
  const [wrong, setWrong] = useState('');
  // Text being typed is kept, whatever else on the page is redrawn meanwhile, even if the connection is lost.
  const [typed, setTyped] = useState<string | null>(null);
  const open = useRef(false); // a typed value has not been applied yet
  const timer = useRef(0);
  useEffect(() => () => clearTimeout(timer.current), []);
  const judge = (why: string) => {
    clearTimeout(timer.current);
    setWrong(why);
  };
  const type = (text: string) => {
    judge('');
    setTyped(text);
    open.current = true;
  };
  const take = async (input: HTMLInputElement) => {
    if (!open.current || disabled) return;
    const v = input.valueAsNumber;
    if (!inRange(v, range)) return judge(wrongText(input.value, range, unit));
    open.current = false;
    judge('');
    await onValue(v);
    if (!open.current) setTyped(null);
  };
  const leave = (input: HTMLInputElement) => {
    if (!open.current || disabled) return;
    open.current = false;
    setTyped(null);
    input.value = String(value); // also if the browser holds an invalid number, reported as ''
    clearTimeout(timer.current);
    timer.current = window.setTimeout(() => setWrong(''), readFor);
  };
  return (
    <span class="number-field">
      <span class="number">
        <input
          type="number"
          aria-label={label}
          aria-invalid={wrong !== '' && typed !== null}
          data-testid={testId}
          step={step}
          value={typed ?? value}
          disabled={disabled}
          onInput={(e) => type(e.currentTarget.value)}
          onChange={(e) => void take(e.currentTarget)}
          onKeyDown={(e) => e.key === 'Enter' && void take(e.currentTarget)}
          onBlur={(e) => leave(e.currentTarget)}
        />
        <span class="unit">{unit}</span>
      </span>
      {wrong && (
        <span class="wrong" role="alert" data-testid={testId && `wrong-${testId}`}>
          {wrong}
        </span>
      )}
    </span>
  );
}
