// Table of markers, contact forces and the target of a led marker.
import { fixed } from '../counted';
import { frame, isRough, scene } from '../store';
import * as look from './view_state';

export function Readings() {
  const at = look.shownFrame.value ?? frame.value;
  const shown = at?.head;
  const head = scene.value?.head;
  if (!shown || !head) return null;
  const mark = isRough(at) && '≈ ';
  const pull = shown.pull;
  return (
    <table class="readings">
      <tbody>
        {head.markers.map((m, k) => (
          <tr key={m.name} data-testid={`marker-${m.name}`}>
            <th>
              {mark}
              {m.name}
            </th>
            {(shown.markers[k] ?? []).map((v) => (
              <td>{fixed(v, 2)}</td>
            ))}
            <td class="unit">mm</td>
          </tr>
        ))}
        {look.pinned.value?.frame.head.markers.map((p, k) => (
          <tr class="pinned-row" key={`pin${k}`}>
            <th>{look.pinned.value!.markers[k]} pinned</th>
            {p.map((v) => (
              <td>{fixed(v, 2)}</td>
            ))}
            <td class="unit">mm</td>
          </tr>
        ))}
        {shown.lead && (
          <tr data-testid="lead">
            <th>{mark}distance to the target</th>
            <td colSpan={3}>{shown.lead.error_mm.toFixed(2)}</td>
            <td class="unit">mm</td>
          </tr>
        )}
        {shown.lead?.settled && !shown.lead.reached && (
          <tr class="limits" data-testid="lead-limits">
            <td colSpan={5}>
              Out of reach, this is the nearest point:{' '}
              {shown.lead.limits.join('; ') || 'no small change of the inputs brings it nearer'}
            </td>
          </tr>
        )}
        {head.obstacles.map((o, k) => {
          const force = shown.contacts?.[k];
          if (!force || Math.hypot(...force) < 1e-9) return null;
          return (
            <tr key={`contact${k}`} data-testid={`contact-${o.name}`}>
              <th>
                {mark}
                {o.object ? `force on ${o.name}` : `force of ${o.name}`}
              </th>
              {force.map((v) => (
                <td>{fixed(v, 2)}</td>
              ))}
              <td class="unit">N</td>
            </tr>
          );
        })}
        {pull && (
          <tr>
            <th>{mark}applied force</th>
            {pull.force_N.map((v) => (
              <td>{fixed(v, 2)}</td>
            ))}
            <td class="unit">N</td>
          </tr>
        )}
      </tbody>
    </table>
  );
}
